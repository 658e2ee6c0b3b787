//! An image in memory: planar channels of real numbers.

use std::ops::Range;

use mipless_codegen::ir::Interface;
use mipless_graph::Type;

use crate::size::Size;

/// Named channels of equal size, each stored along the rows from the top left. `T` is f32, or f64
/// for a run of the oracle.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T = f32> {
    size: Size,
    names: Vec<String>,
    channels: Vec<Vec<T>>,
}

impl<T> Image<T> {
    /// An image.
    ///
    /// # Panics
    /// If there is not one name a channel, or a channel does not have one number a pixel.
    pub fn new<N: ToString>(size: Size, names: &[N], channels: Vec<Vec<T>>) -> Self {
        assert_eq!(names.len(), channels.len(), "names of channels");
        for channel in &channels {
            assert_eq!(
                channel.len(),
                size.pixels(),
                "numbers of a channel of {size:?}"
            );
        }
        Self {
            size,
            names: names.iter().map(N::to_string).collect(),
            channels,
        }
    }

    /// The width and the height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The width in pixels.
    pub fn width(&self) -> u32 {
        self.size.width
    }

    /// The height in pixels.
    pub fn height(&self) -> u32 {
        self.size.height
    }

    /// The names of the channels.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The numbers of the channels.
    pub fn channels(&self) -> &[Vec<T>] {
        &self.channels
    }

    /// The numbers of the channels.
    pub fn channels_mut(&mut self) -> &mut [Vec<T>] {
        &mut self.channels
    }

    /// The channel of that name.
    pub fn channel(&self, name: &str) -> Option<&[T]> {
        let index = self.names.iter().position(|n| n == name)?;
        Some(&self.channels[index])
    }
}

impl<T: Copy> Image<T> {
    /// The mean of one output, from an image that holds all results of a program; its channels are
    /// named by [`channel_names`].
    pub fn mean(&self, output: &Output) -> Self {
        self.slice(output.mean.clone(), output.ty)
    }

    /// The variance of one output, where the program computes it.
    pub fn variance(&self, output: &Output) -> Option<Self> {
        output
            .variance
            .clone()
            .map(|range| self.slice(range, output.ty))
    }

    fn slice(&self, range: Range<usize>, ty: Type) -> Self {
        Self::new(self.size, channel_names(ty), self.channels[range].to_vec())
    }
}

impl Image<f32> {
    /// Means and variances as one image with the channels `mean.C…` and `variance.C…`.
    ///
    /// # Panics
    /// If the two differ in size or channels.
    pub fn moments(mean: &Self, variance: &Self) -> Self {
        assert_eq!(mean.names, variance.names, "channels of the moments");
        let named = |kind: &'static str| mean.names.iter().map(move |c| format!("{kind}.{c}"));
        let names: Vec<_> = named("mean").chain(named("variance")).collect();
        let channels = mean
            .channels
            .iter()
            .chain(&variance.channels)
            .cloned()
            .collect();
        Self::new(mean.size, &names, channels)
    }
}

impl Image<f64> {
    /// The nearest f32 numbers.
    pub fn to_f32(&self) -> Image {
        let narrow = |channel: &Vec<f64>| channel.iter().map(|&x| x as f32).collect();
        Image::new(
            self.size,
            &self.names,
            self.channels.iter().map(narrow).collect(),
        )
    }
}

/// The names of the channels of a type: `R,G,B[,A]` for colours, `X,Y[,Z,W]` for vectors, `Y` for
/// one number. Text has none.
pub fn channel_names(ty: Type) -> &'static [&'static str] {
    match ty {
        Type::Float | Type::Integer | Type::Boolean => &["Y"],
        Type::Vector2 => &["X", "Y"],
        Type::Vector3 => &["X", "Y", "Z"],
        Type::Vector4 => &["X", "Y", "Z", "W"],
        Type::Color3 => &["R", "G", "B"],
        Type::Color4 => &["R", "G", "B", "A"],
        Type::String | Type::Filename => &[],
    }
}

/// Where one output of a program lies among its results.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The name in the graph.
    pub name: String,
    /// The type.
    pub ty: Type,
    /// The results that hold its mean.
    pub mean: Range<usize>,
    /// The results that hold its variance, where the program computes moments.
    pub variance: Option<Range<usize>>,
}

/// The outputs of a program, in order.
pub fn outputs(interface: &Interface) -> Vec<Output> {
    let total: usize = interface
        .outputs
        .iter()
        .map(|port| port.ty.components())
        .sum();
    let mut start = 0;
    let place = |port: &mipless_codegen::ir::Port| {
        let mean = start..start + port.ty.components();
        start = mean.end;
        let variance = interface
            .moments
            .then(|| mean.start + total..mean.end + total);
        Output {
            name: port.name.clone(),
            ty: port.ty,
            mean,
            variance,
        }
    };
    interface.outputs.iter().map(place).collect()
}

/// The names of all results of a program: `OUTPUT.C` for the means, then `OUTPUT.variance.C`.
pub(crate) fn result_names(interface: &Interface) -> Vec<String> {
    let named = |kind: &str| {
        let port = |port: &mipless_codegen::ir::Port| {
            let name = |c| format!("{}{kind}.{c}", port.name);
            channel_names(port.ty).iter().map(name).collect::<Vec<_>>()
        };
        interface.outputs.iter().flat_map(port).collect::<Vec<_>>()
    };
    let mut names = named("");
    if interface.moments {
        names.extend(named(".variance"));
    }
    names
}

#[cfg(test)]
mod tests {
    use mipless_codegen::ir::Port;

    use super::*;

    #[test]
    fn variances_follow_all_means() {
        let port = |name: &str, ty| Port {
            name: name.into(),
            ty,
            default: Vec::new(),
        };
        let interface = Interface {
            name: "test".into(),
            parameters: Vec::new(),
            outputs: vec![port("height", Type::Float), port("tint", Type::Color3)],
            moments: true,
            position: false,
        };
        let found = outputs(&interface);
        assert_eq!(
            (found[1].mean.clone(), found[1].variance.clone()),
            (1..4, Some(5..8))
        );
        let names = result_names(&interface);
        assert_eq!(names.len(), 8);
        let size = Size::new(1, 1);
        let all = Image::new(size, &names, (0..8u8).map(|i| vec![f32::from(i)]).collect());
        let (mean, variance) = (all.mean(&found[1]), all.variance(&found[1]).unwrap());
        assert_eq!(mean.channel("G"), Some(&[2.0][..]));
        assert_eq!(variance.channel("B"), Some(&[7.0][..]));
        let moments = Image::moments(&mean, &variance);
        assert_eq!(moments.channel("variance.R"), Some(&[5.0][..]));
    }
}
