//! The choice of a kernel at each lattice point.

use super::affine::Affine;
use super::field::Spread;
use super::lattice::{self, WAVELENGTH};
use super::perlin::{self, Kind};
use super::steep::{self, Band};
use super::sum::Octaves;
use mipless_codegen::ir::Scalar;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Lower, NodeRule};
use mipless_graph::Node;

/// What is at each lattice point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// The quadrupole.
    Gaussian,
    /// The quintic window.
    Quintic(Kind),
}

impl Kernel {
    /// The node's `kernel`.
    pub(crate) fn of(lower: &Lower<'_, '_>, node: &Node) -> Self {
        if lower.choice(node, "kernel") == "quintic" {
            Self::Quintic(Kind::Gradient)
        } else {
            Self::Gaussian
        }
    }

    /// The filtered sum of octaves at a position in cells of the first octave: pivot + amplitude · X,
    /// where the first octave of X has variance 1 and |X| is at most `extent`. What the filter
    /// removed is private.
    pub(crate) fn signal<'b>(
        self,
        lower: &mut Lower<'_, 'b>,
        position: &[Signal<'b>],
        octaves: Octaves,
        shape: Affine<'b>,
    ) -> Signal<'b> {
        let Octaves {
            count,
            part,
            lacunarity,
            diminish,
            period,
            ..
        } = octaves;
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let mut literals = vec![
            count,
            part.to_bits(),
            lacunarity.to_bits(),
            diminish.to_bits(),
            period,
        ];
        if let Self::Quintic(Kind::Materialx(byte)) = self {
            literals.push(u32::from(byte));
        }
        if let Self::Quintic(Kind::Materialmaker { seed }) = self {
            literals.push(seed as u32);
        }
        if octaves.ratio != 1.0 {
            literals.push(octaves.ratio.to_bits());
        }
        let of = NodeRule {
            name: match self {
                Self::Gaussian => "lattice_noise",
                Self::Quintic(kind) => kind.rule(),
            },
            doc: "A filtered sum of octaves, as a signal.",
            literals: &literals,
        };
        let numbers = [
            ("seed", octaves.scrambled_seed(lower.b()).into()),
            ("amplitude", shape.amplitude.into()),
            ("pivot", shape.pivot.into()),
        ];
        let signals = [(super::field::X, x), (super::field::Y, y)];
        lower.rule(of, &signals, &numbers, |lower, position, numbers| {
            let seed = numbers[0].uint();
            let [amplitude, pivot] = [numbers[1], numbers[2]].map(Scalar::float);
            let field = match self {
                Self::Gaussian => lattice::filtered(lower, position, octaves, seed),
                Self::Quintic(kind) => perlin::filtered(lower, position, kind, octaves, seed),
            };
            let steep = field.steep(lower, position, |lower| {
                let spread = Spread::of(position);
                steep::of_bands(lower, &spread, &self.bands(octaves))
            });
            (steep * amplitude).offset(pivot)
        })
    }

    /// The spectrum of a sum of octaves, in cells of the first, which has variance 1.
    fn bands(self, octaves: Octaves) -> Vec<Band> {
        let (order, area) = match self {
            Self::Gaussian => (2, lattice::AREA),
            Self::Quintic(kind) => kind.band(),
        };
        let shares = (0..octaves.count).map(|_| 1.0);
        let shares = shares.chain((octaves.part > 0.0).then_some(octaves.part));
        (0..)
            .zip(shares)
            .map(|(k, share): (i32, f32)| Band {
                order,
                area: area / octaves.lacunarity.powi(2 * k),
                variance: (share * octaves.diminish.powi(k)).powi(2),
            })
            .collect()
    }

    /// Reports what the footprint is to a sum of octaves at this position, in cells of the first
    /// octave, which dominates.
    pub(crate) fn report<'b>(
        self,
        lower: &mut Lower<'_, 'b>,
        position: &[Signal<'b>],
        octaves: Octaves,
    ) {
        if !lower.measures() {
            return;
        }
        let wavelength = match self {
            Self::Gaussian => WAVELENGTH,
            Self::Quintic(kind) => kind.wavelength(),
        };
        let size = Spread::of(position).eigenvalues[0].sqrt();
        lower.source_detail(size * (1.0 / wavelength), octaves.finer());
    }
}
