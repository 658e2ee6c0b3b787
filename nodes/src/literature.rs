//! What the reference pages cite, each work in the same words.

/// The references of a page: names of the entries here, or sentences. A name after `;` is that of
/// the node in the specification of `MaterialX`: `cite!(isserlis, bussgang; "power")`.
macro_rules! cite {
    (@ abramowitz_polynomial) => {
        "Abramowitz & Stegun 4.4.49 (the polynomial)."
    };
    (@ arctangent) => {
        "Abramowitz & Stegun 1964, 4.4.49 (arctangent)."
    };
    (@ blending) => {
        "W3C, *Compositing and Blending Level 1*, §10 (blend modes)."
    };
    (@ bussgang) => {
        "Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
         Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1."
    };
    (@ characteristic) => {
        "The characteristic function of the normal distribution, in *Abramowitz & Stegun* 26.2."
    };
    (@ clark) => {
        "Clark 1961, *The Greatest of a Finite Set of Random Variables*, eqs. 2–6."
    };
    (@ color_mapped) => {
        "Heitz, Nowrouzezahrai, Poulin & Neyret 2013, *Filtering Color Mapped Textures and \
         Surfaces*, §4."
    };
    (@ folded) => {
        "Leone, Nelson & Nottingham 1961, *The Folded Normal Distribution*."
    };
    (@ heckbert) => {
        "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8."
    };
    (@ hexcone) => {
        "Smith 1978, *Color Gamut Transform Pairs* (the hexcone)."
    };
    (@ isserlis) => {
        "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a normal \
         frequency distribution* (fourth moments from second ones)."
    };
    (@ linear) => {
        "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient and \
         Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance)."
    };
    (@ marsaglia) => {
        "Marsaglia 2006, *Ratios of Normal Variables*, §2 (no moments without truncation)."
    };
    (@ porter_duff) => {
        "Porter & Duff 1984, *Compositing Digital Images*, §4."
    };
    (@ rec709) => {
        "ITU-R BT.709-6, item 3.2."
    };
    (@ stroud) => {
        "Stroud 1971, *Approximate Calculation of Multiple Integrals*, U_n 5."
    };
    (@ truncated) => {
        "The truncated normal distribution, in Johnson, Kotz & Balakrishnan 1994, *Continuous \
         Univariate Distributions*, vol. 1, §13.10."
    };
    (@ $sentence:literal) => {
        $sentence
    };
    (; $node:expr) => {
        concat!("MaterialX 1.39 specification, node `", $node, "`.")
    };
    ($first:tt $(, $more:tt)* $(; $node:expr)?) => {
        concat!(cite!(@ $first) $(, " ", cite!(@ $more))* $(, " ", cite!(; $node))?)
    };
}
