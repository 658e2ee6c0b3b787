//! Rendering: views, the CPU renderer, wgpu, truth, error metrics and image files.
