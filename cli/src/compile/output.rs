//! The folder of shaders: what is in it already, and what is written into it.

use crate::mistake::Mistake;
use crate::sources::Sources;
use mipless::Files;
use mipless::artifact::Artifact;
use mipless::manifest::sha256;
use mipless_runtime::image_file::write_all;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::fmt::{self, Display};
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// What was made of a graph.
pub(super) struct Done {
    /// The files beside it that it reads.
    pub(super) reads: Vec<PathBuf>,
    /// What is to be written, unless all of it is there.
    pub(super) made: Made,
}

/// What is to be written.
pub(super) enum Made {
    /// Nothing: the folder holds it, and this manifest says so.
    Unchanged(Box<Value>),
    /// These files.
    Files(Box<Artifact>),
}

/// What a manifest begins with.
const BEGINNING: &[u8] = b"{\n  \"compiler\": \"mipless ";

/// The folder.
pub(super) struct Folder {
    out: PathBuf,
    /// The manifests that are in it, by the keys of what they describe.
    known: HashMap<String, Value>,
    /// Who writes what, so that two graphs of one name do not overwrite each other.
    owners: BTreeMap<PathBuf, PathBuf>,
}

/// What was written of a graph.
pub(super) struct Written {
    /// All files that there are of it, the manifest last.
    pub(super) files: Vec<PathBuf>,
    manifest: Value,
    /// Those that were not as they should be.
    changed: Vec<PathBuf>,
    /// Those of another run that hold no longer, and are gone.
    removed: Vec<PathBuf>,
}

impl Folder {
    /// Looks at the manifests in the folder, if there is one.
    pub(super) fn open(out: &Path) -> Self {
        let entries = fs::read_dir(out).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path());
        let is_named = |path: &PathBuf| path.extension().is_some_and(|found| found == "json");
        let manifests = paths.filter(is_named).filter_map(|path| manifest(&path));
        let keyed = manifests.filter_map(|manifest| {
            let key = manifest["source"]["key"].as_str()?.to_owned();
            Some((key, manifest))
        });
        Self {
            out: out.to_owned(),
            known: keyed.collect(),
            owners: BTreeMap::new(),
        }
    }

    /// The manifest of what has this key, if all that these targets need is here and whole, written with
    /// options of this key, of files that still hold what they held.
    pub(super) fn unchanged(
        &self,
        key: &str,
        targets: &[&str],
        target_key: &str,
        files: &dyn Files,
    ) -> Option<&Value> {
        let manifest = self.known.get(key)?;
        let has = |target: &&str| {
            let target = &manifest["targets"][*target];
            target["key"] == target_key && self.holds(&target["file"], &target["sha256"])
        };
        let tables = &manifest["files"]["tables"];
        let has_tables = tables.is_null() || self.holds(tables, &manifest["tables_data"]["sha256"]);
        let whole = targets.iter().all(has) && has_tables && reads_the_same(manifest, files);
        whole.then_some(manifest)
    }

    /// Whether a file of the folder has this digest.
    fn holds(&self, name: &Value, digest: &Value) -> bool {
        let bytes = name
            .as_str()
            .filter(|name| is_plain(name))
            .and_then(|name| fs::read(self.out.join(name)).ok());
        bytes.is_some_and(|bytes| *digest == sha256(&bytes))
    }

    /// Writes what is not there already, and removes what another run has left that holds no longer.
    pub(super) fn write(
        &mut self,
        path: &Path,
        done: &Done,
        sources: &Sources,
    ) -> Result<Written, Mistake> {
        let artifact = match &done.made {
            Made::Unchanged(manifest) => {
                let names = names(manifest).into_iter().map(|(_, name)| name);
                let mut files: Vec<PathBuf> = names.map(|name| self.out.join(name)).collect();
                files.push(self.manifest_of(manifest));
                self.claim(path, &files, None)?;
                return Ok(Written {
                    files,
                    manifest: (**manifest).clone(),
                    changed: Vec::new(),
                    removed: Vec::new(),
                });
            }
            Made::Files(artifact) => artifact,
        };
        let place = self.out.join(artifact.manifest_name());
        let (written, stale) = self.merged(artifact, manifest(&place));
        let mut files: Vec<(PathBuf, Vec<u8>)> = (artifact.files.iter())
            .map(|file| (self.out.join(&file.name), file.bytes.clone()))
            .collect();
        files.push((place, format!("{written:#}\n").into_bytes()));
        let paths: Vec<PathBuf> = files.iter().map(|(file, _)| file.clone()).collect();
        self.claim(path, &paths, Some(sources))?;

        files.retain(|(file, bytes)| !fs::read(file).is_ok_and(|held| held == *bytes));
        let unwritable = |error: &dyn Display| {
            Mistake::usage(
                "unwritable-file",
                format!("{}: {error}", self.out.display()),
            )
        };
        fs::create_dir_all(&self.out).map_err(|error| unwritable(&error))?;
        write_all(&files).map_err(|error| unwritable(&error))?;
        let mut removed = Vec::new();
        for file in stale.into_iter().map(|name| self.out.join(name)) {
            let is_ours = !self.owners.contains_key(&file) && sources.guard(&file).is_ok();
            // What is gone already, or cannot be removed, is at least listed no longer.
            if is_ours && fs::remove_file(&file).is_ok() {
                removed.push(file);
            }
        }
        Ok(Written {
            files: paths,
            manifest: written,
            changed: files.into_iter().map(|(file, _)| file).collect(),
            removed,
        })
    }

    /// The manifest of an artifact with what an older run has left that still holds, and the names of
    /// what it has left that does not.
    fn merged(&self, artifact: &Artifact, older: Option<Value>) -> (Value, Vec<String>) {
        let mut manifest: Value =
            serde_json::from_str(&artifact.manifest.to_json()).unwrap_or(Value::Null);
        let Some(older) = older else {
            return (manifest, Vec::new());
        };
        let still = !manifest["source"].is_null() && older["source"] == manifest["source"];
        let mut stale = Vec::new();
        for (key, name) in names(&older) {
            if manifest["files"].get(&key).is_some() {
                // A target's file may have had another extension.
                if manifest["files"][&key] != name {
                    stale.push(name);
                }
                continue;
            }
            let target = &older["targets"][&key];
            if still && self.holds(&target["file"], &target["sha256"]) {
                manifest["targets"][&key] = target.clone();
                manifest["files"][&key] = name.into();
            } else {
                stale.push(name);
            }
        }
        for table in ["targets", "files"] {
            if let Some(Value::Object(members)) = manifest.get_mut(table) {
                members.sort_keys();
            }
        }
        (manifest, stale)
    }

    /// Where the manifest of what is unchanged lies.
    fn manifest_of(&self, manifest: &Value) -> PathBuf {
        let first = names(manifest).into_iter().next();
        let stem = first.map_or(String::new(), |(_, name)| {
            name.split('.').next().unwrap_or_default().to_owned()
        });
        self.out.join(format!("{stem}.json"))
    }

    /// Refuses to write over a graph, or over what another graph of this run has written.
    fn claim(
        &mut self,
        path: &Path,
        files: &[PathBuf],
        sources: Option<&Sources>,
    ) -> Result<(), Mistake> {
        for file in files {
            if let Some(sources) = sources {
                let read = sources.guard(file);
                read.map_err(|mistake| mistake.help("choose another folder with `--out`"))?;
            }
            if let Some(owner) = self.owners.get(file) {
                let message = format!(
                    "{} and {} would both write {}",
                    owner.display(),
                    path.display(),
                    file.display()
                );
                return Err(
                    Mistake::usage("same-name", message).help("give the graphs different names")
                );
            }
        }
        let owned = files.iter().map(|file| (file.clone(), path.to_path_buf()));
        self.owners.extend(owned);
        Ok(())
    }
}

impl Written {
    /// What tools are told.
    pub(super) fn to_json(&self, path: &Path) -> Value {
        let shown = |files: &[PathBuf]| -> Vec<String> {
            files
                .iter()
                .map(|file| file.display().to_string())
                .collect()
        };
        json!({
            "graph": path.display().to_string(),
            "files": shown(&self.files),
            "changed": shown(&self.changed),
            "removed": shown(&self.removed),
            "manifest": self.manifest,
        })
    }
}

/// What people are told.
impl Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |files: &[PathBuf]| {
            let names: Vec<String> = files
                .iter()
                .map(|file| file.display().to_string())
                .collect();
            names.join(", ")
        };
        if self.changed.is_empty() && self.removed.is_empty() {
            return f.write_str("unchanged");
        }
        f.write_str(&shown(&self.changed))?;
        if !self.removed.is_empty() {
            write!(f, "; removed {}", shown(&self.removed))?;
        }
        Ok(())
    }
}

/// The manifest in a file, if it is one.
fn manifest(path: &Path) -> Option<Value> {
    let mut file = File::open(path).ok()?;
    let mut bytes = vec![0; BEGINNING.len()];
    file.read_exact(&mut bytes).ok()?;
    if bytes != BEGINNING {
        return None;
    }
    file.read_to_end(&mut bytes).ok()?;
    serde_json::from_slice(&bytes).ok()
}

/// The files that a manifest lists, by their keys; a name that leads elsewhere is none.
fn names(manifest: &Value) -> Vec<(String, String)> {
    let files = manifest["files"].as_object().into_iter().flatten();
    let named = files.filter_map(|(key, name)| Some((key.clone(), name.as_str()?.to_owned())));
    named.filter(|(_, name)| is_plain(name)).collect()
}

/// Whether a name is one of a file in the folder itself.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!(
        (parts.next(), parts.next()),
        (Some(std::path::Component::Normal(_)), None)
    )
}

/// Whether what the graph reads holds what it held.
fn reads_the_same(manifest: &Value, files: &dyn Files) -> bool {
    let read = manifest["source"]["files"].as_array();
    read.is_some_and(|read| {
        read.iter().all(|file| {
            let bytes = file["name"].as_str().and_then(|name| files.read(name).ok());
            bytes.is_some_and(|bytes| file["sha256"] == sha256(&bytes))
        })
    })
}
