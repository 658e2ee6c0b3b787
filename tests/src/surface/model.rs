//! The closed forms, on the evaluator in f32, of the exact moments of a field.

use super::{Averages, Direction, Field};
use mipless_codegen::cpu::{Evaluator, Input, Scratch};
use mipless_codegen::ir::Module;
use mipless_codegen::shade::FIELDS;
use std::fmt;

/// The numbers of a surface over each pixel, by the names of [`FIELDS`].
#[derive(Clone, Debug)]
pub struct Moments {
    pixels: usize,
    fields: Vec<Vec<Vec<f32>>>,
}

impl Moments {
    /// Of a white, matt, flat surface, for so many pixels.
    pub fn flat(pixels: usize) -> Self {
        let default = |name: &str| match name {
            "base_color" | "mean_roughness" | "mean_occlusion" | "slope_share" => 1.0,
            _ => 0.0,
        };
        let field = |&(name, components)| vec![vec![default(name); pixels]; components];
        Self {
            pixels,
            fields: FIELDS.iter().map(field).collect(),
        }
    }

    /// Of the slopes of a field under a Gaussian, a share of whose facets slopes: the share of each pixel
    /// where its facets say of themselves whether they do.
    pub fn of_slopes(field: &Field, averages: &Averages<'_>, sd: f64, mixed: bool) -> Self {
        let mean = |f: &dyn Fn([f64; 2]) -> f64| averages.filtered(&field.each(|_, s| f(s)), sd);
        let (u, v) = (mean(&|s| s[0]), mean(&|s| s[1]));
        let second = [
            mean(&|s| s[0] * s[0]),
            mean(&|s| s[0] * s[1]),
            mean(&|s| s[1] * s[1]),
        ];
        let products: [fn(f64, f64) -> f64; 3] = [|x, _| x * x, |x, y| x * y, |_, y| y * y];
        let mut moments = Self::flat(u.len());
        let means = [&u, &v].map(|m| m.clone());
        let covariances = [0, 1, 2].map(|k| {
            let of = |i: usize| second[k][i] - products[k](u[i], v[i]);
            (0..u.len()).map(of).collect::<Vec<f64>>()
        });
        moments.set("slope_mean", &means);
        moments.set("slope_covariance", &covariances);
        if mixed {
            let share = mean(&|s| f64::from(u8::from(s != [0.0, 0.0])));
            moments.set("slope_share", &[share]);
        }
        moments
    }

    /// The number of pixels.
    pub const fn pixels(&self) -> usize {
        self.pixels
    }

    /// Sets a field, component by component.
    ///
    /// # Panics
    /// If there is no such field, or if it has other components or pixels.
    pub fn set(&mut self, name: &str, components: &[Vec<f64>]) {
        let to = self.field(name);
        assert_eq!(to.len(), components.len(), "components of {name}");
        for (to, from) in to.iter_mut().zip(components) {
            assert_eq!(to.len(), from.len(), "pixels");
            *to = from.iter().map(|&x| x as f32).collect();
        }
    }

    /// Sets all components of a field in all pixels.
    ///
    /// # Panics
    /// If there is no such field.
    pub fn fill(&mut self, name: &str, x: f64) {
        self.field(name)
            .iter_mut()
            .flatten()
            .for_each(|to| *to = x as f32);
    }

    fn field(&mut self, name: &str) -> &mut Vec<Vec<f32>> {
        let index = FIELDS.iter().position(|field| field.0 == name);
        &mut self.fields[index.unwrap_or_else(|| panic!("no field {name}"))]
    }
}

/// A function of a surface and of numbers that are the same in all pixels.
pub struct Model {
    evaluator: Evaluator<f32>,
}

impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.evaluator.fmt(f)
    }
}

impl Model {
    /// Of a module whose entry takes a surface first.
    pub fn new(module: &Module) -> Self {
        Self {
            evaluator: Evaluator::new(module),
        }
    }

    /// The results, one vector each.
    pub fn evaluate(&self, moments: &Moments, rest: &[f64]) -> Vec<Vec<f64>> {
        let fields = moments.fields.iter().flatten();
        let inputs: Vec<Input<'_>> = fields
            .map(|component| Input::Floats(component))
            .chain(rest.iter().map(|&x| Input::Float(x as f32)))
            .collect();
        let mut outputs = Vec::new();
        let mut scratch = Scratch::new();
        self.evaluator
            .evaluate(&mut scratch, &inputs, moments.pixels, &mut outputs);
        outputs
            .into_iter()
            .map(|all| all.into_iter().map(f64::from).collect())
            .collect()
    }

    /// The results for an eye and a light.
    pub fn between(&self, moments: &Moments, view: Direction, light: Direction) -> Vec<Vec<f64>> {
        self.evaluate(moments, &[view, light].concat())
    }
}
