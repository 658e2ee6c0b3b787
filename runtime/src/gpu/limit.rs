//! What a device is not given.

/// The longest program that a device is given, in instructions once calls are expanded, as drivers
/// expand them: compiling takes longer than linear, and cannot be stopped. A software device (one
/// thread of a server, LLVM 15) took 40 s for 218,000 and 61 s for 305,000; NVIDIA's driver 580 took
/// 21 s for about 200,000.
pub const LARGEST_PROGRAM: u64 = 300_000;
