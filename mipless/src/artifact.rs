//! A texture as files: its shader in every target that is asked for, its tables, and a manifest.

mod named;

use crate::form::Form;
use crate::manifest::{Manifest, ManifestSource, ManifestTexture, sha256};
use crate::target::{Target, TranslateError, Validated, validate};
use crate::wgsl::{self, DECLARATIONS, Shader, TABLE_WIDTH, TableForm};
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
    /// The files for hosts.
    pub forms: Vec<Form>,
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
        let emit = |options: &wgsl::Options| match recipe.is_shaded {
            true => wgsl::emit_shaded(&program, options),
            false => wgsl::emit(&program, options),
        };
        // Most want what the first wants: a text is read once.
        let first = first_emission(recipe);
        let mut last = Text::new(first, emit(&first))?;
        let shader = last.shader.clone();
        let mut manifest = Manifest::new(texture, &shader, &recipe.options, audit.as_ref());
        manifest.source.clone_from(&recipe.source);
        let stem = stem_of(&shader.function).to_owned();
        let mut is_texture = false;
        let mut at = |options: wgsl::Options, last: &mut Text| {
            is_texture |= options.tables != TableForm::Storage;
            if last.options != options {
                *last = Text::new(options, emit(&options))?;
            }
            Ok::<_, TranslateError>(())
        };
        let mut files = Vec::new();
        for &target in &recipe.targets {
            let tables = target.tables(first.tables);
            at(wgsl::Options { tables, ..first }, &mut last)?;
            let Text {
                shader, validated, ..
            } = &last;
            let bytes = validated.translate(shader, target)?;
            let stage = shader.entry_point.as_ref().map(|entry| entry.stage);
            let name = format!("{stem}.{}", target.extension(stage));
            let mut described = named::described(target, shader, validated, &bytes);
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
        let range = |name: &str| {
            let parameter = texture.parameters().iter().find(|p| p.name == name);
            parameter.map_or((None, None), |p| (p.min, p.max))
        };
        for &form in &recipe.forms {
            at(form.emission(first), &mut last)?;
            let written = form.files(&last.validated, &last.shader, &stem, range)?;
            let several = written.len() > 1;
            for file in written {
                let key = match several {
                    true => format!("{} {}", form.name(), file.extension),
                    false => form.name().to_owned(),
                };
                files.push(ArtifactFile {
                    key,
                    name: format!("{stem}.{}", file.extension),
                    bytes: file.text.into_bytes(),
                });
            }
        }
        if let Some(tables) = &shader.tables {
            let numbers = if is_texture {
                manifest.tables_texture = Some(ManifestTexture {
                    width: TABLE_WIDTH,
                    height: tables.rows(),
                    format: "r32float",
                });
                tables.texels()
            } else {
                tables.data()
            };
            let bytes: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
            if let Some(data) = &mut manifest.tables_data {
                data.length = (bytes.len() / 4) as u32;
                data.sha256 = sha256(&bytes);
            }
            files.push(ArtifactFile {
                key: "tables".to_owned(),
                name: format!("{stem}.tables.bin"),
                bytes,
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

    /// Adds a file that another room makes.
    pub fn push(&mut self, key: &str, extension: &str, bytes: Vec<u8>) {
        let name = format!("{}.{extension}", self.stem);
        self.manifest.files.insert(key.to_owned(), name.clone());
        self.files.push(ArtifactFile {
            key: key.to_owned(),
            name,
            bytes,
        });
    }

    /// The name of the manifest's file.
    pub fn manifest_name(&self) -> String {
        format!("{}.json", self.stem)
    }
}

/// A text that is read and validated.
struct Text {
    options: wgsl::Options,
    shader: Shader,
    validated: Validated,
}

impl Text {
    /// One that declares no `Footprint` is read behind its declaration.
    fn new(options: wgsl::Options, shader: Shader) -> Result<Self, TranslateError> {
        let validated = if options.shared_footprint {
            validate(&format!("{}{}", *DECLARATIONS, shader.source))?
        } else {
            validate(&shader.source)?
        };
        Ok(Self {
            options,
            shader,
            validated,
        })
    }
}

/// How a graph is emitted where nothing is special: as its first target or form wants it.
fn first_emission(recipe: &Recipe) -> wgsl::Options {
    let asked = recipe.emission;
    match (recipe.targets.first(), recipe.forms.first()) {
        (Some(target), _) => wgsl::Options {
            tables: target.tables(asked.tables),
            ..asked
        },
        (None, Some(form)) => form.emission(asked),
        (None, None) => asked,
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
