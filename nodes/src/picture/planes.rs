//! A picture as planes of linear numbers, as many as a type has components.

use mipless_graph::{Picture, Type, linear_from_srgb};

/// The numbers of a picture, one plane a component, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Planes {
    /// Texels in a row, and rows.
    pub(crate) size: [usize; 2],
    /// At least one.
    pub(crate) planes: Vec<Vec<f64>>,
}

impl Planes {
    /// The planes of a picture for a type: grey spreads to all colours, alpha is 1 unless there is
    /// one, further components are 0, and one number is the first. Colours become linear.
    pub(crate) fn of(picture: &Picture, ty: Type, linearise: bool) -> Self {
        let count = ty.components();
        let stored = picture.channels() as usize;
        let grey = stored <= 2;
        let colored = matches!(ty, Type::Color3 | Type::Color4);
        let alpha = [None, Some(1), None, Some(3)][stored - 1];
        let plane = |component: usize| -> Vec<f64> {
            let opacity = ty == Type::Color4 && component == 3;
            let channel = match (opacity, colored) {
                (true, _) => alpha,
                (false, true) if grey => Some(0),
                _ => Some(component).filter(|&c| c < stored),
            };
            let absent = if opacity { 1.0 } else { 0.0 };
            let texels = picture.numbers().chunks_exact(stored);
            texels
                .map(|texel| match channel {
                    None => absent,
                    Some(channel) if linearise && !opacity => {
                        linear_from_srgb(texel[channel].into())
                    }
                    Some(channel) => texel[channel].into(),
                })
                .collect()
        };
        Self {
            size: [picture.width() as usize, picture.height() as usize],
            planes: (0..count).map(plane).collect(),
        }
    }

    /// The least and the largest number of each plane.
    pub(crate) fn ranges(&self) -> Vec<[f32; 2]> {
        let range = |plane: &Vec<f64>| {
            let bounds = [f64::INFINITY, f64::NEG_INFINITY];
            let fold = |[low, high]: [f64; 2], &x: &f64| [low.min(x), high.max(x)];
            plane.iter().fold(bounds, fold).map(|x| x as f32)
        };
        self.planes.iter().map(range).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_become_what_the_type_wants() {
        let two = Picture::new((1, 1), 2, true, vec![0.5, 0.25]);
        let color4 = Planes::of(&two, Type::Color4, true).planes;
        let grey = linear_from_srgb(0.5);
        assert_eq!(color4, [[grey], [grey], [grey], [0.25]]);
        assert_eq!(Planes::of(&two, Type::Float, false).planes, [[0.5]]);
        let three = Picture::new((1, 1), 3, false, vec![0.1, 0.2, 0.3]);
        let four = Planes::of(&three, Type::Color4, false).planes;
        assert_eq!(four[3], [1.0]);
        let vector = Planes::of(&three, Type::Vector4, false).planes;
        assert_eq!(vector[3], [0.0]);
    }
}
