//! What hosts make of filtered slopes: one lobe, by the rules of their literature.

use super::Direction;
use std::f64::consts::PI;

/// A rule that makes one lobe of the slopes of a footprint. All have a mean slope of 0 here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {
    /// The mean normal with the roughness of the facets: no filter.
    Mean,
    /// Toksvig 2005: a round lobe by the length of the mean normal.
    Toksvig,
    /// Olano & Baker 2010 (LEAN): Beckmann's lobe of the covariance of slopes and ½ α².
    Lean,
    /// Kaplanyan et al. 2016: α² + 2 S, of which no more than .18 is added.
    Clamped,
    /// α² + 2 S, as the node `surface` gives it.
    Surface,
}

impl Host {
    /// Every rule.
    pub const ALL: [Self; 5] = [
        Self::Mean,
        Self::Toksvig,
        Self::Lean,
        Self::Clamped,
        Self::Surface,
    ];

    /// π D G₂/(4 n·o), of slopes with this covariance, whose normals have a mean of this length.
    pub fn mirrored(
        self,
        [uu, uv, vv]: [f64; 3],
        length: f64,
        alpha: f64,
        [view, light]: [Direction; 2],
    ) -> f64 {
        let own = alpha * alpha;
        let a = match self {
            Self::Mean => [own, 0.0, own],
            Self::Toksvig => {
                let shininess = 2.0 / own - 2.0;
                let wider = length * shininess / (length + shininess * (1.0 - length));
                let square = 2.0 / (wider + 2.0);
                [square, 0.0, square]
            }
            Self::Lean | Self::Surface => [own + 2.0 * uu, 2.0 * uv, own + 2.0 * vv],
            Self::Clamped => {
                let added = (uu + vv).min(0.18);
                [own + added, 0.0, own + added]
            }
        };
        let sum = [0, 1, 2].map(|k| view[k] + light[k]);
        let [x, y] = [sum[0] / sum[2], sum[1] / sum[2]];
        let squares = sum.iter().map(|c| c * c).sum::<f64>();
        let height = sum[2] * sum[2] / squares;
        let determinant = a[0] * a[2] - a[1] * a[1];
        let form = (x * x * a[2] - 2.0 * x * y * a[1] + y * y * a[0]) / determinant;
        // Of Beckmann's lobe α² is twice the variance of the slopes.
        let shape = match self {
            Self::Lean => (-form).exp(),
            _ => (1.0 + form).powi(-2),
        };
        let d = shape / (PI * determinant.sqrt() * height * height);
        let lambda = |[x, y, z]: Direction| {
            let form = x * x * a[0] + 2.0 * x * y * a[1] + y * y * a[2];
            0.5 * ((1.0 + form / (z * z)).sqrt() - 1.0)
        };
        PI * d / (4.0 * view[2] * (1.0 + lambda(view) + lambda(light)))
    }
}
