//! A texture as files: its shader in every target that is asked for, its tables, and a manifest.

mod named;

use crate::manifest::{Manifest, ManifestSource, bytes_of, sha256};
use crate::target::{Target, TranslateError, validate};
use crate::wgsl::{self, DECLARATIONS};
use crate::{Options, Texture};

/// The most letters of a file's name that come from the graph's, which are ASCII: folders take names
/// of 255 bytes.
const LONGEST_STEM: usize = 200;

/// What is made of a texture.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// How it is compiled.
    pub options: Options,
    /// How its WGSL is written.
    pub emission: wgsl::Options,
    /// The targets.
    pub targets: Vec<Target>,
    /// Whether the functions that light a material stand beside its own: [`wgsl::emit_shaded`].
    pub is_shaded: bool,
    /// Where the graph came from, for the manifest.
    pub source: Option<ManifestSource>,
}

/// A texture as files, none of which is written yet.
#[derive(Clone, Debug)]
pub struct Artifact {
    /// What all names begin with.
    pub stem: String,
    /// The shaders and the tables.
    pub files: Vec<ArtifactFile>,
    /// What a host needs to know of them.
    pub manifest: Manifest,
}

/// A file of an artifact.
#[derive(Clone, Debug)]
pub struct ArtifactFile {
    /// Its key in the manifest's `files`: the target's name, or `tables`.
    pub key: String,
    /// Its name.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

impl Artifact {
    /// Compiles a texture.
    ///
    /// # Errors
    /// If a target needs an entry point that the recipe has not, or naga rejects the shader: a bug of
    /// the compiler.
    pub fn new(texture: &Texture, recipe: &Recipe) -> Result<Self, TranslateError> {
        let (program, audit) = texture.compile_audited(&recipe.options);
        let emit = if recipe.is_shaded {
            wgsl::emit_shaded
        } else {
            wgsl::emit
        };
        let shader = emit(&program, &recipe.emission);
        let validated = if recipe.emission.shared_footprint {
            validate(&format!("{}{}", *DECLARATIONS, shader.source))?
        } else {
            validate(&shader.source)?
        };
        let mut manifest = Manifest::new(texture, &shader, &recipe.options, audit.as_ref());
        manifest.source.clone_from(&recipe.source);
        let stem = stem_of(&shader.function).to_owned();
        let mut files = Vec::new();
        for &target in &recipe.targets {
            let bytes = validated.translate(&shader, target)?;
            let stage = shader.entry_point.as_ref().map(|entry| entry.stage);
            let name = format!("{stem}.{}", target.extension(stage));
            let mut described = named::described(target, &shader, &validated, &bytes);
            described.file.clone_from(&name);
            described.sha256 = sha256(&bytes);
            described.key = target_key(&recipe.emission);
            manifest.targets.insert(target.name().to_owned(), described);
            files.push(ArtifactFile {
                key: target.name().to_owned(),
                name,
                bytes,
            });
        }
        if let Some(tables) = &shader.tables {
            files.push(ArtifactFile {
                key: "tables".to_owned(),
                name: format!("{stem}.tables.bin"),
                bytes: bytes_of(tables),
            });
        }
        let named = files
            .iter()
            .map(|file| (file.key.clone(), file.name.clone()));
        manifest.files = named.collect();
        Ok(Self {
            stem,
            files,
            manifest,
        })
    }

    /// The name of the manifest's file.
    pub fn manifest_name(&self) -> String {
        format!("{}.json", self.stem)
    }
}

/// What the names of the files begin with, of a texture whose function has this name.
fn stem_of(function: &str) -> &str {
    &function[..function.len().min(LONGEST_STEM)]
}

/// A digest of the options that concern the text of a target alone.
pub fn target_key(emission: &wgsl::Options) -> String {
    sha256(format!("{emission:?}").as_bytes())
}
