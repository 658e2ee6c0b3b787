//! The words that no emitted name may be: keywords, reserved words, built-in functions and types of
//! WGSL, GLSL, HLSL and MSL.
//!
//! Names are compared in lower case as well as literally, because HLSL's compiler takes some of its
//! keywords in any case; the lists below therefore hold lower-case spellings where that is enough.

use rustc_hash::FxHashSet;
use std::sync::LazyLock;

/// WGSL: keywords, and words reserved for later.
const WGSL_KEYWORDS: &str = "
    alias break case const const_assert continue continuing default diagnostic discard else enable
    false fn for if let loop override requires return struct switch true var while NULL Self
    abstract active alignas alignof as asm asm_fragment async attribute auto await become cast catch
    class co_await co_return co_yield coherent column_major common compile compile_fragment concept
    const_cast consteval constexpr constinit crate debugger decltype delete demote demote_to_helper
    do dynamic_cast enum explicit export extends extern external fallthrough filter final finally
    friend from fxgroup get goto groupshared highp impl implements import inline instanceof
    interface layout lowp macro macro_rules match mediump meta mod module move mut mutable namespace
    new nil noexcept noinline nointerpolation non_coherent noncoherent noperspective null nullptr of
    operator package packoffset partition pass patch pixelfragment precise precision premerge priv
    protected pub public readonly ref regardless register reinterpret_cast require resource restrict
    self set shared sizeof smooth snorm static static_assert static_cast std subroutine super target
    template this thread_local throw trait try type typedef typeid typename typeof union unless
    unorm unsafe unsized use using varying virtual volatile wgsl where with writeonly yield";

/// WGSL: built-in functions and types.
const WGSL: &str = "
    abs acos acosh all any array arraylength asin asinh atan atan2 atanh atomic bitcast bool ceil
    clamp cos cosh countleadingzeros countonebits counttrailingzeros cross degrees determinant
    distance dot dpdx dpdxcoarse dpdxfine dpdy dpdycoarse dpdyfine exp exp2 extractbits f16 f32
    faceforward firstleadingbit firsttrailingbit floor fma fract frexp fwidth i32 insertbits
    inversesqrt ldexp length log log2 mat2x2 mat2x2f mat2x3 mat2x3f mat2x4 mat2x4f mat3x2 mat3x2f
    mat3x3 mat3x3f mat3x4 mat3x4f mat4x2 mat4x2f mat4x3 mat4x3f mat4x4 mat4x4f max min mix modf
    normalize pow ptr quantizetof16 radians reflect refract reversebits round sampler saturate
    select sign sin sinh smoothstep sqrt step storagebarrier tan tanh texture transpose trunc u32
    unpack vec2 vec2f vec2i vec2u vec3 vec3f vec3i vec3u vec4 vec4f vec4i vec4u workgroupbarrier";

/// GLSL: keywords, words reserved for later and built-in functions.
const GLSL: &str = "
    active asm atomic_uint attribute bool break buffer bvec2 bvec3 bvec4 case cast centroid class
    coherent common const continue default discard dmat2 dmat3 dmat4 do double dvec2 dvec3 dvec4
    else enum extern external false filter fixed flat float for fvec2 fvec3 fvec4 goto half highp
    hvec2 hvec3 hvec4 if iimage2d image1d image2d image3d in inline inout input int interface
    invariant isampler2d ivec2 ivec3 ivec4 layout long lowp main mat2 mat3 mat4 mediump namespace
    noinline noise1 noise2 noise3 noise4 noperspective notinline out output partition patch precise
    precision public readonly resource restrict return sample sampler1d sampler2d sampler3d
    samplercube shared short sizeof smooth static struct subroutine superp switch template texel
    textureload texturesample this true typedef uimage2d uint uniform union unsigned usampler2d
    using uvec2 uvec3 uvec4 varying vec void volatile while writeonly acosh bitcount dfdx dfdy
    equal exp findlsb findmsb floatbitstoint floatbitstouint fwidth greaterthan imod
    intbitstofloat inverse inversesqrt isinf isnan lessthan matrixcompmult memorybarrier mod not
    notequal outerproduct packhalf2x16 roundeven texelfetch texturegrad texturelod texturesize
    uintbitstofloat umulextended usubborrow barrier";

/// HLSL: keywords and intrinsic functions.
const HLSL: &str = "
    appendstructuredbuffer asfloat asint asm_fragment asuint blendstate byteaddressbuffer cbuffer
    clip column_major compile compile_fragment compileshader computeshader consumestructuredbuffer
    ddx ddx_coarse ddx_fine ddy ddy_coarse ddy_fine decl depthstencilstate depthstencilview
    domainshader dst dword export f16tof32 f32tof16 firstbithigh firstbitlow float1 float2 float3
    float4 fmod frac fxgroup geometryshader globallycoherent groupshared half2 half3 half4
    hullshader inputpatch int1 int2 int3 int4 isfinite lerp line lineadj linear lit log10 mad
    matrix min16float min10float min16int min12int min16uint msad4 mul nointerpolation nullptr
    numthreads outputpatch packoffset pass pixelfragment pixelshader point pointstream
    linestream triangle triangleadj trianglestream printf rasterizerstate rcp register
    rendertargetview row_major rsqrt rwbuffer rwbyteaddressbuffer rwstructuredbuffer
    rwtexture1d rwtexture2d rwtexture3d samplercomparisonstate samplerstate sincos snorm
    stateblock stateblock_state string structuredbuffer tbuffer technique technique10 technique11
    tex1d tex2d tex3d texcube texture1d texture2d texture3d texturecube uint1 uint2 uint3 uint4
    unorm vector vertexfragment vertexshader noperspective errorf abort all any determinant";

/// MSL: the keywords of C++14, Metal's own words and library names that are macros or types there.
const MSL: &str = "
    access alignas alignof and and_eq as_type auto bitand bitor catch char char16_t char32_t compl
    const_cast constant constexpr decltype delete device dynamic_cast enum explicit fragment friend
    half2 imageblock int8_t int16_t int32_t int64_t kernel metal mutable new noexcept not_eq
    nullptr object_data operator or or_eq packed_float2 packed_float3 packed_float4 private
    protected ptrdiff_t ray_data register reinterpret_cast size_t signed simd static_assert
    static_cast thread thread_local threadgroup threadgroup_imageblock throw try typeid typename
    uchar uint8_t uint16_t uint32_t uint64_t ulong ushort vertex virtual visible wchar_t xor
    xor_eq clock infinity nan huge_valf maxfloat m_pi_f m_e_f null assert divide powr fmin fmax
    fabs fmin3 fmax3 median3 min3 max3 ctz clz popcount rint rsqrt sinpi cospi tanpi discard_fragment
    coherent mesh object depth2d texture2d_array sampler_state as_type char2 char3 char4 bool2 bool3
    bool4 short2 short3 short4 uchar2 uchar3 uchar4 ushort2 ushort3 ushort4 long2 long3 long4
    float2x2 float3x3 float4x4 atomic_int atomic_bool true false sizeof";

static WORDS: LazyLock<FxHashSet<&'static str>> = LazyLock::new(|| {
    [WGSL_KEYWORDS, WGSL, GLSL, HLSL, MSL]
        .into_iter()
        .flat_map(str::split_whitespace)
        .collect()
});

/// Whether a target language takes this word for itself.
pub(super) fn is_reserved(word: &str) -> bool {
    is_word(word) || word.starts_with("gl_")
}

/// Whether it is one of the words; not of those that GLSL takes by how they begin.
pub(super) fn is_word(word: &str) -> bool {
    WORDS.contains(word)
        || word.bytes().any(|b| b.is_ascii_uppercase())
            && WORDS.contains(word.to_ascii_lowercase().as_str())
}

#[cfg(all(test, feature = "targets"))]
mod tests {
    use super::*;

    #[test]
    fn the_keywords_of_wgsl_are_those_of_naga() {
        let ours: FxHashSet<&str> = WGSL_KEYWORDS.split_whitespace().collect();
        let theirs = naga::keywords::wgsl::RESERVED.iter().copied().collect();
        assert_eq!(ours, theirs);
    }
}
