//! What other programs call ports, and what of them is not here: answers for people who come from
//! one of them.

use crate::NodeSpec;

/// Names of ports elsewhere, and those that may be meant here, the likeliest first.
const PORTS: [(&[&str], &[&str]); 22] = [
    (
        &["scale"],
        &["frequency", "uvtiling", "columns", "size", "amount"],
    ),
    (
        &["detail", "iterations", "levels", "layers", "octave"],
        &["octaves"],
    ),
    (&["roughness", "persistence", "dimension"], &["diminish"]),
    (&["fac", "factor", "blend", "opacity", "weight"], &["mix"]),
    (
        &["strength", "intensity", "height"],
        &["amplitude", "amount", "scale", "mix"],
    ),
    (&["distortion"], &["strength", "amplitude"]),
    (
        &[
            "vector",
            "uv",
            "uvs",
            "st",
            "coord",
            "coords",
            "coordinates",
            "mapping",
        ],
        &["texcoord", "position", "in"],
    ),
    (
        &["value", "input", "image", "color", "source", "x"],
        &["in", "in1", "value"],
    ),
    (
        &["a", "input1", "color1", "value1", "background"],
        &["in1", "bg"],
    ),
    (
        &["b", "input2", "color2", "value2", "foreground"],
        &["in2", "fg"],
    ),
    (&["angle", "rotation"], &["rotate", "amount", "orientation"]),
    (
        &["location", "translate", "translation", "shift", "offset"],
        &["uvoffset", "offset", "pivot"],
    ),
    (
        &["repeat", "tiling", "tile", "tiles"],
        &["uvtiling", "period", "columns", "frequency"],
    ),
    (&["threshold", "cutoff"], &["edge", "low"]),
    (&["min", "minimum", "frommin", "lower"], &["low", "inlow"]),
    (&["max", "maximum", "frommax", "upper"], &["high", "inhigh"]),
    (&["tomin"], &["outlow"]),
    (&["tomax"], &["outhigh"]),
    (&["randomness"], &["jitter"]),
    (&["mortarsize", "gap"], &["mortar"]),
    (
        &["softness", "feather", "smoothness"],
        &["edge", "bevel", "width"],
    ),
    (
        &["ramp", "gradient", "colors", "keys", "points"],
        &["stops"],
    ),
];

/// Names of nodes elsewhere that are not here, and what to do instead.
const NODES: [(&[&str], &str); 8] = [
    (
        &[
            "scatter",
            "tilesampler",
            "splatter",
            "tiler",
            "shapesplatter",
            "instanceonpoints",
        ],
        "figures are not scattered here: `tiledcircles` and `tiledhexagons` repeat them, and \
         `worleynoise2d` has cells at random places",
    ),
    (
        &["ambientocclusion", "occlusion", "ao", "curvature"],
        "there are no passes over pixels: a height less its `blur` says where it lies low",
    ),
    (
        &[
            "fresnel",
            "layerweight",
            "facingratio",
            "viewdirection",
            "camera",
        ],
        "a texture does not know the direction of view: whoever reads it does",
    ),
    (
        &["geometry", "objectinfo", "vertexcolor", "attribute"],
        "a texture knows its coordinates (`texcoord`, `position`) and nothing else of the surface; what \
         else there is may be an input of the graph",
    ),
    (
        &["time", "frame", "scenetime"],
        "time is an input of the graph: declare it under `inputs`, and read it by { \"input\": \"time\" }",
    ),
    (
        &["raymarching", "raymarch", "sdf", "sdfbox", "sdfsphere"],
        "there are no scenes in space: `circle`, `shape` and `brick` are figures of the plane, with soft edges",
    ),
    (
        &[
            "shader",
            "principledbsdf",
            "standardsurface",
            "openpbrsurface",
            "material",
        ],
        "a texture is read by a material: name the outputs as its inputs are named",
    ),
    (
        &[
            "script",
            "osl",
            "glsl",
            "expression",
            "pixelprocessor",
            "customexpression",
        ],
        "code is not run here, since what filters it is not known: `add`, `multiply`, `sin` and the other \
         nodes are its arithmetic",
    ),
];

/// Letters and digits, in lower case.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters.flat_map(char::to_lowercase).collect()
}

/// What a port of another program is called here.
pub(super) fn port(name: &str, spec: &NodeSpec) -> Option<String> {
    let name = plain(name);
    let known = PORTS.iter().filter(|(names, _)| names.contains(&&*name));
    let meant = known
        .flat_map(|(_, ports)| ports.iter())
        .find(|port| spec.input(port).is_some())?;
    Some(format!("here it is called `{meant}`"))
}

/// What to do where a node of another program is not here.
pub(super) fn node(name: &str) -> Option<String> {
    let name = plain(name);
    let found = NODES.iter().find(|(names, _)| names.contains(&&*name));
    found.map(|(_, answer)| (*answer).to_owned())
}
