//! Every tolerance of the suites, with its reason. Those of the laws of composition stand with the laws.

pub use mipless::conformance::tolerance::{
    FAR_FIELD, LEFT_OUT, RANGE, ROUNDING, SPREAD, VANISHING,
};

/// The difference, relative to max(1, |x|), up to which a pixel in f32 *agrees* with its f64 oracle:
/// about 80 roundings of a number near 1, which is what a graph of some hundred operations makes.
/// Pixels beyond it sit on an edge or in a cancellation, where f32 carries no information.
pub const F32_AGREES: f64 = 1e-5;

/// The largest difference between a device and the CPU over the pixels that agree with the oracle,
/// relative to max(1, |x|). WGSL lets a device be off by 2.5 units in the last place in a division,
/// by 3 + 2|x| in exp and by 2⁻¹¹ absolutely in sin and cos; the devices met so far stay a hundred
/// times below that.
pub const DEVICE: f64 = 2e-4;

/// The level of significance of the hypothesis tests of one suite together; each test of `n` gets
/// 1/n of it (Bonferroni). With fixed random numbers a suite passes always or never.
pub const SIGNIFICANCE: f64 = 1e-3;

/// The error that the check predicts is an estimate from measured cascades over all footprints. What
/// is measured is at most the first times it, and it is at most the second times what is measured.
pub const PREDICTED: [f64; 2] = [1.25, 4.0];

/// The root mean square error of one step or ramp of a noise over a footprint of an eighth of its
/// wavelength: what filtering the source leaves, without any error of the bounds.
pub const BOUNDED: f64 = 0.025;

/// What filtering the sources themselves is off by, and the samples of the truth: no prediction has
/// it.
pub const SOURCE: f64 = 0.01;

/// The two-sided p-value of a standard normal number, from above: Mills' ratio is at most 1/z.
pub fn p_value(z: f64) -> f64 {
    let z = z.abs();
    let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
    (2.0 * density / z).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::p_value;

    #[test]
    fn p_values_bound_the_normal_tail_closely() {
        // 2(1 − Φ(3)) = 0.0026998, 2(1 − Φ(5)) = 5.7330e-7.
        assert!(
            (0.002_699_8..0.003).contains(&p_value(3.0)),
            "{}",
            p_value(3.0)
        );
        assert!(
            (5.733e-7..5.97e-7).contains(&p_value(-5.0)),
            "{}",
            p_value(-5.0)
        );
        assert_eq!(p_value(0.0), 1.0);
    }
}
