//! What one evaluation of a texture sees.

/// A position in texture space and its change from pixel to pixel. The position is `cell + uv`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// The whole part of the position.
    pub cell: [i32; 2],
    /// The rest of the position.
    pub uv: [f32; 2],
    /// The change of uv from a pixel to the next one to the right.
    pub du: [f32; 2],
    /// The change of uv from a pixel to the next one below.
    pub dv: [f32; 2],
}
