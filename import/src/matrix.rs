//! Arithmetic of matrices that are literals. A vector is a row that stands before them.

/// The matrices of an operation by the name of MaterialX's node; nothing where it has none.
pub(crate) fn operate(name: &str, left: &[f64], right: &[f64]) -> Option<Vec<f64>> {
    let size = left.len().isqrt();
    // One number stands for all entries.
    let right = match right {
        [x] => vec![*x; left.len()],
        _ if right.len() == left.len() => right.to_vec(),
        _ => return None,
    };
    let entries = |f: fn(f64, f64) -> f64| {
        left.iter()
            .zip(&right)
            .map(|(a, b)| f(*a, *b))
            .collect::<Vec<f64>>()
    };
    match name {
        "add" => Some(entries(|a, b| a + b)),
        "subtract" => Some(entries(|a, b| a - b)),
        "multiply" => Some(product(left, &right, size)),
        "divide" => Some(product(left, &inverse(&right)?, size)),
        _ => None,
    }
}

fn product(left: &[f64], right: &[f64], size: usize) -> Vec<f64> {
    let entry = |i: usize| {
        let (row, column) = (i / size, i % size);
        (0..size)
            .map(|k| left[row * size + k] * right[k * size + column])
            .sum()
    };
    (0..size * size).map(entry).collect()
}

/// Rows as columns.
pub(crate) fn transpose(matrix: &[f64]) -> Vec<f64> {
    let size = matrix.len().isqrt();
    (0..size * size)
        .map(|i| matrix[i % size * size + i / size])
        .collect()
}

/// Without a row and a column.
fn minor(matrix: &[f64], row: usize, column: usize) -> Vec<f64> {
    let size = matrix.len().isqrt();
    let kept = |i: &usize| i / size != row && i % size != column;
    (0..size * size).filter(kept).map(|i| matrix[i]).collect()
}

/// By expansion along the first row; the matrices are of at most four rows.
pub(crate) fn determinant(matrix: &[f64]) -> f64 {
    if matrix.len() <= 1 {
        return matrix.first().copied().unwrap_or(1.0);
    }
    let size = matrix.len().isqrt();
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    (0..size)
        .map(|i| sign(i) * matrix[i] * determinant(&minor(matrix, 0, i)))
        .sum()
}

/// The inverse, if there is one.
pub(crate) fn inverse(matrix: &[f64]) -> Option<Vec<f64>> {
    let size = matrix.len().isqrt();
    let whole = determinant(matrix);
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    let entry = |i: usize| {
        let (row, column) = (i / size, i % size);
        sign(row + column) * determinant(&minor(matrix, column, row)) / whole
    };
    let inverse: Vec<f64> = (0..size * size).map(entry).collect();
    inverse.iter().all(|x| x.is_finite()).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_one() {
        let matrix = [2.0, 1.0, 0.0, -1.0, 3.0, 4.0, 0.5, 0.0, 1.0];
        let one = operate("divide", &matrix, &matrix).expect("it has an inverse");
        for (i, entry) in one.iter().enumerate() {
            let wanted = f64::from(u8::from(i % 4 == 0));
            assert!((entry - wanted).abs() < 1e-12, "{one:?}");
        }
        assert!((determinant(&matrix) - 9.0).abs() < 1e-12);
        assert_eq!(transpose(&transpose(&matrix)), matrix);
        assert_eq!(inverse(&[0.0; 16]), None);
    }
}
