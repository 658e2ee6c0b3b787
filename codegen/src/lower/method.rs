//! Methods: one axis from fast to exact.

use std::{fmt, str::FromStr};

/// How a texture is filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// Per pixel, `quad` where it pays, else `local`.
    Auto,
    /// Not at all.
    Point,
    /// f(filtered input): what mipmapping does.
    Naive,
    /// One variance per source and footprint.
    Ensemble,
    /// Mean, gradient, remainder.
    Local,
    /// The same with Hessian and third cumulant.
    Quad,
    /// This many real sub-footprints (4, 7 or 16), each by `quad`.
    Split(u32),
    /// This many points, quasi-Monte-Carlo: the truth.
    Supersample(u32),
}

impl Method {
    /// The most samples of [`Method::Supersample`].
    pub const MOST_SAMPLES: u32 = 1 << 20;
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Point => f.write_str("point"),
            Self::Naive => f.write_str("naive"),
            Self::Ensemble => f.write_str("ensemble"),
            Self::Local => f.write_str("local"),
            Self::Quad => f.write_str("quad"),
            Self::Split(k) => write!(f, "split:{k}"),
            Self::Supersample(n) => write!(f, "supersample:{n}"),
        }
    }
}

/// A name that is no method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseMethodError(String);

impl fmt::Display for ParseMethodError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "`{}` is no method: auto, point, naive, ensemble, local, quad, split:4, split:7, split:16, \
             or supersample:N with N from 1 to {}",
            self.0,
            Method::MOST_SAMPLES
        )
    }
}

impl std::error::Error for ParseMethodError {}

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || ParseMethodError(text.to_owned());
        Ok(match text {
            "auto" => Self::Auto,
            "point" => Self::Point,
            "naive" => Self::Naive,
            "ensemble" => Self::Ensemble,
            "local" => Self::Local,
            "quad" => Self::Quad,
            "split:4" => Self::Split(4),
            "split:7" => Self::Split(7),
            "split:16" => Self::Split(16),
            _ => {
                let samples = text.strip_prefix("supersample:").ok_or_else(error)?;
                let samples: u32 = samples.parse().map_err(|_| error())?;
                if samples == 0 || samples > Self::MOST_SAMPLES {
                    return Err(error());
                }
                Self::Supersample(samples)
            }
        })
    }
}

/// The filter over which a pixel is averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PixelFilter {
    /// A Gaussian of this standard deviation, in pixels.
    Gaussian(f32),
    /// The square of the pixel; closed forms match its variance, 1/12.
    Box,
}

impl Default for PixelFilter {
    fn default() -> Self {
        Self::Gaussian(0.5)
    }
}

impl PixelFilter {
    /// The standard deviation, in pixels.
    pub fn sd(self) -> f32 {
        match self {
            Self::Gaussian(sd) => sd,
            Self::Box => (1.0f32 / 12.0).sqrt(),
        }
    }
}

/// As the command line and the manifest write it.
impl fmt::Display for PixelFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gaussian(sd) => write!(f, "gaussian:{sd}"),
            Self::Box => f.write_str("box"),
        }
    }
}
