//! Ranges: a literal's numbers, or the whole [min, max] of an input of the graph, against what a
//! port accepts.

use crate::{Parameter, Range};

/// Why numbers from `low` to `high` (inclusive) do not fit into a range; `None` if they do.
pub(super) fn refusal(range: &Range, low: f32, high: f32) -> Option<String> {
    if low < range.min || high > range.max {
        return Some(if range.max == f32::MAX {
            format!("at least {} is wanted", range.min)
        } else if range.min == f32::MIN {
            format!("at most {} is wanted", range.max)
        } else {
            format!("a number from {} to {} is wanted", range.min, range.max)
        });
    }
    let zero = range.nonzero && low <= 0.0 && high >= 0.0;
    zero.then(|| "0 is not accepted, for it divides".to_owned())
}

/// The smallest and the largest value that an input of the graph can have.
pub(super) fn bounds(parameter: &Parameter) -> (f32, f32) {
    (
        parameter.min.unwrap_or(f32::MIN),
        parameter.max.unwrap_or(f32::MAX),
    )
}

/// The first of the numbers that does not lie between bounds.
pub(crate) fn outside(numbers: &[f32], min: Option<f32>, max: Option<f32>) -> Option<f32> {
    let fits =
        |number: f32| min.is_none_or(|min| number >= min) && max.is_none_or(|max| number <= max);
    numbers.iter().copied().find(|number| !fits(*number))
}

/// Bounds for messages.
pub(crate) fn shown_bounds(min: Option<f32>, max: Option<f32>) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!("from {min} to {max}"),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (None, None) => "any number".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_divisor_refuses_every_interval_around_zero() {
        let range = Range::soft(0.0, 1.0).nonzero();
        assert!(refusal(&range, -1.0, 1.0).is_some());
        assert!(refusal(&range, 0.0, 1.0).is_some());
        assert!(refusal(&range, f32::MIN, f32::MAX).is_some());
        assert_eq!(refusal(&range, 0.5, 64.0), None);
        assert!(
            refusal(&Range::hard(1.0, 12.0), -3.0, -3.0)
                .expect("refused")
                .contains("from 1 to 12")
        );
    }
}
