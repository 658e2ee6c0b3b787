//! What a document is asked for: the inputs of the shaders of its materials, or, where it has no
//! material, the outputs of its nodegraphs.

use super::network::Network;
use crate::build::Refusal;
use crate::element::{Id, Tree};
use crate::surface::{self, Shader};
use mipless_graph::{Diagnostic, Type};
use rustc_hash::FxHashSet;

/// An output of the graph that is to be.
#[derive(Clone, Debug)]
pub(crate) struct Root {
    pub(crate) name: String,
    /// The nodegraph that the element stands in, or the document.
    pub(crate) graph: Id,
    /// An `<input>` of a shader or an `<output>`.
    pub(crate) element: Id,
    /// The shader of a surface that it is an input of, as its place in [`Roots::surfaces`].
    pub(crate) surface: Option<usize>,
}

/// A shader that becomes the node `surface`.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) shader: &'static Shader,
    pub(crate) element: Id,
    /// What the names of outputs begin with, where there are several shaders.
    pub(crate) prefix: String,
}

/// Everything that is asked for.
#[derive(Debug, Default)]
pub(crate) struct Roots {
    pub(crate) outputs: Vec<Root>,
    pub(crate) surfaces: Vec<Surface>,
}

/// A shader of a document.
#[derive(Clone, Copy, Debug)]
struct Found {
    graph: Id,
    node: Id,
    /// The material that it is of.
    material: Option<Id>,
}

/// Types that shaders have and textures have not.
const OPAQUE: [&str; 12] = [
    "matrix33",
    "matrix44",
    "surfaceshader",
    "displacementshader",
    "volumeshader",
    "lightshader",
    "material",
    "BSDF",
    "EDF",
    "VDF",
    "multioutput",
    "none",
];

/// Everything that is asked for; `material` is the name of a material, a shader or a nodegraph.
pub(crate) fn find(network: &mut Network<'_>, material: Option<&str>) -> Result<Roots, Refusal> {
    let tree = &network.tree;
    let mut shaders: Vec<Found> = Vec::new();
    let mut graphs: Vec<Id> = Vec::new();
    let is_wanted = |id: Id| material.is_none_or(|name| tree.get(id).name == name);
    for id in tree.children(Tree::ROOT) {
        match tree.get(id).tag.as_str() {
            "surfacematerial" | "volumematerial" if is_wanted(id) => {
                for input in tree.tagged(id, "input") {
                    let found = shader(tree, Tree::ROOT, input);
                    shaders.extend(found.map(|(graph, node)| Found {
                        graph,
                        node,
                        material: Some(id),
                    }));
                }
            }
            "nodegraph" if material.is_some() && is_wanted(id) => graphs.push(id),
            _ => {}
        }
    }
    if let Some(name) = material
        && shaders.is_empty()
        && graphs.is_empty()
    {
        match tree.child(Tree::ROOT, name) {
            Some(node) => shaders.push(Found {
                graph: Tree::ROOT,
                node,
                material: None,
            }),
            None => {
                let known: Vec<&str> = (tree.tagged(Tree::ROOT, "surfacematerial"))
                    .map(|id| tree.get(id).name.as_str())
                    .collect();
                let message = format!("there is no material `{name}`: {}", known.join(", "));
                return Err(Refusal::new("import-reference", message));
            }
        }
    }
    let mut seen = FxHashSet::default();
    shaders.retain(|shader| seen.insert(shader.node));
    let mut dropped = Vec::new();
    let (mut roots, surfaces) = inputs(tree, &shaders, &mut dropped);
    if roots.is_empty() && material.is_none() {
        graphs.extend(shown_graphs(tree));
    }
    // Where nodegraphs are shown, shaders without inputs are not.
    let surfaces = if graphs.is_empty() {
        surfaces
    } else {
        Vec::new()
    };
    let several = graphs.len() > 1;
    for graph in graphs {
        for output in tree.tagged(graph, "output") {
            let element = tree.get(output);
            if !is_texture(element.attribute("type").unwrap_or("")) {
                dropped.push((output, format!("`{}` is no texture", element.name)));
                continue;
            }
            roots.push(Root {
                name: if several && graph != Tree::ROOT {
                    format!("{}_{}", tree.get(graph).name, element.name)
                } else {
                    element.name.clone()
                },
                graph,
                element: output,
                surface: None,
            });
        }
    }
    for (id, what) in dropped {
        let place = network.tree.place(id);
        let note = format!("{what} and is left out");
        network
            .findings
            .say(&place, Diagnostic::note("import-left-out", note));
    }
    distinct(&mut roots);
    Ok(Roots {
        outputs: roots,
        surfaces,
    })
}

/// The inputs of shaders; those that are no textures are dropped. A displacement belongs to the surface
/// of its material.
fn inputs(
    tree: &Tree,
    shaders: &[Found],
    dropped: &mut Vec<(Id, String)>,
) -> (Vec<Root>, Vec<Surface>) {
    let known = |found: &Found| surface::shader(&tree.get(found.node).tag);
    let is_displacement = |found: &Found| tree.get(found.node).tag == "displacement";
    // The shader whose surface an input belongs to.
    let owner = |found: &Found| {
        if known(found).is_some() || !is_displacement(found) {
            return *found;
        }
        let beside = |other: &&Found| other.material == found.material && known(other).is_some();
        (shaders.iter())
            .find(|other| found.material.is_some() && beside(other))
            .copied()
            .unwrap_or(*found)
    };
    let mut owners: Vec<Id> = shaders.iter().map(|found| owner(found).node).collect();
    owners.sort_unstable();
    owners.dedup();
    let several = owners.len() > 1;
    let prefix = |node: Id| match several {
        true => format!("{}_", tree.get(node).name.replace([':', '/'], "_")),
        false => String::new(),
    };
    let mut surfaces: Vec<Surface> = Vec::new();
    for found in shaders {
        surfaces.extend(known(found).map(|shader| Surface {
            shader,
            element: found.node,
            prefix: prefix(found.node),
        }));
    }
    let mut roots = Vec::new();
    for found in shaders {
        let owner = owner(found);
        let surface = surfaces
            .iter()
            .position(|surface| surface.element == owner.node);
        for input in tree.tagged(found.node, "input") {
            let element = tree.get(input);
            let own = &element.name;
            let ty = element.attribute("type").unwrap_or("");
            if !is_texture(ty) {
                dropped.push((input, format!("`{own}` of a shader is no texture")));
                continue;
            }
            // A displacement along the normal is a height; others are signals of their own.
            let is_part = !is_displacement(found) || ty == "float";
            roots.push(Root {
                name: format!("{}{own}", prefix(owner.node)),
                graph: found.graph,
                element: input,
                surface: surface.filter(|_| is_part),
            });
        }
    }
    (roots, surfaces)
}

/// Nodegraphs that show something by themselves, and the document if it has outputs. Functional ones
/// are shown where there is nothing else.
fn shown_graphs(tree: &Tree) -> Vec<Id> {
    let graphs = tree.tagged(Tree::ROOT, "nodegraph");
    let (plain, functional): (Vec<Id>, Vec<Id>) =
        graphs.partition(|id| tree.get(*id).attribute("nodedef").is_none());
    let document = tree.tagged(Tree::ROOT, "output").next().map(|_| Tree::ROOT);
    let shown: Vec<Id> = plain.into_iter().chain(document).collect();
    if shown.is_empty() { functional } else { shown }
}

/// The shader node that an input of a material, or of a shader, reads, and the graph it stands in.
fn shader(tree: &Tree, graph: Id, input: Id) -> Option<(Id, Id)> {
    let (mut graph, mut at) = (graph, input);
    for _ in 0..64 {
        let element = tree.get(at);
        if let Some(name) = element.attribute("nodegraph") {
            graph = tree.child(Tree::ROOT, name)?;
            let output = element.attribute("output");
            at = (tree.tagged(graph, "output"))
                .find(|id| output.is_none_or(|output| tree.get(*id).name == output))?;
            continue;
        }
        let node = tree.child(graph, element.attribute("nodename")?)?;
        return match tree.get(node).tag.as_str() {
            "nodegraph" => {
                graph = node;
                at = tree.tagged(graph, "output").next()?;
                continue;
            }
            "output" | "input" => {
                at = node;
                continue;
            }
            _ => Some((graph, node)),
        };
    }
    None
}

/// Whether a texture may be of that type; types of a document's own are refused where they are read.
fn is_texture(ty: &str) -> bool {
    !OPAQUE.contains(&ty) && Type::by_name(ty).is_none_or(|ty| ty.components() > 0)
}

/// Gives every output a name of its own.
fn distinct(roots: &mut [Root]) {
    let mut seen = FxHashSet::default();
    for root in roots {
        let wanted = root.name.replace([':', '/'], "_");
        let mut name = wanted.clone();
        let mut count = 1;
        while !seen.insert(name.clone()) {
            count += 1;
            name = format!("{wanted}_{count}");
        }
        root.name = name;
    }
}
