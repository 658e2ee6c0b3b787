//! The energy of the filtered lattice noise and its derivatives by the footprint.

use mipless_codegen::ir::{Builder, Value};

/// The energy that the filter leaves, F(Σ)/F(0), and V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1,
/// all shares of F(0), from the eigenvalues of Σ/a².
pub(super) fn energies(b: &mut Builder, y: [Value; 2]) -> [Value; 3] {
    let one = b.f32(1.0);
    let p = y.map(|y| {
        let raised = b.add(y, one);
        b.div(one, raised)
    });
    let x = [b.mul(y[0], p[0]), b.mul(y[1], p[1])];
    let xp = [b.mul(x[0], p[0]), b.mul(x[1], p[1])];
    let p1 = b.add(p[0], p[1]);
    let p2 = b.dot(&p, &p);
    // N = p₁² + 2p₂ and its derivatives by λ.
    let squared = b.square(p1);
    let doubled = b.add(p2, p2);
    let n = b.add(squared, doubled);
    let d1 = b.add(xp[0], xp[1]);
    let d2 = b.dot(&xp, &p);
    let first = b.mul(p1, d1);
    let first = b.scale(first, -2.0);
    let second = b.scale(d2, -4.0);
    let n1 = b.add(first, second);
    let e1 = b.dot(&x, &xp);
    let e2 = b.dot(&xp, &xp);
    let part = b.square(d1);
    let part = b.scale(part, 2.0);
    let cross = b.mul(p1, e1);
    let cross = b.scale(cross, 4.0);
    let last = b.scale(e2, 12.0);
    let n2 = b.add(part, cross);
    let n2 = b.add(n2, last);
    // D = √(p₁p₂): D′ = −½ tr X D, D″ = (¼ (tr X)² + ½ tr X²) D.
    let product = b.mul(p[0], p[1]);
    let root = b.sqrt(product);
    let root = b.scale(root, 0.125);
    let trace = b.add(x[0], x[1]);
    let trace2 = b.dot(&x, &x);
    let f = b.mul(n, root);
    let half = b.scale(trace, -0.5);
    let drop = b.mul(n, half);
    let v1 = b.add(n1, drop);
    let v1 = b.mul(v1, root);
    let v1 = b.neg(v1);
    let quarter = b.square(half);
    let halved = b.scale(trace2, 0.5);
    let bend = b.add(quarter, halved);
    let bend = b.mul(n, bend);
    let cross = b.mul(n1, trace);
    let sum = b.sub(n2, cross);
    let sum = b.add(sum, bend);
    let v2 = b.mul(sum, root);
    let v2 = b.scale(v2, 0.5);
    [f, v1, v2]
}
