//! A document as a tree of elements with attributes, whatever it was written in: MaterialX's XML and
//! glTF's JSON become the same tree.

use crate::place::Place;
use rustc_hash::FxHashMap;

/// The position of an element in its tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Id(pub(crate) u32);

/// An element: `<multiply name="scale" type="float">`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Element {
    pub(crate) tag: String,
    pub(crate) name: String,
    pub(crate) attributes: Vec<(String, String)>,
    pub(crate) parent: Option<Id>,
    pub(crate) children: Vec<Id>,
    /// The file and the byte where it begins.
    pub(crate) file: usize,
    pub(crate) offset: usize,
}

impl Element {
    /// An attribute; one that is empty is as good as none.
    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(key, _)| key == name);
        found
            .map(|(_, value)| value.as_str())
            .filter(|value| !value.is_empty())
    }

    /// Sets an attribute.
    pub(crate) fn set(&mut self, name: &str, value: &str) {
        match self.attributes.iter_mut().find(|(key, _)| key == name) {
            Some((_, old)) => value.clone_into(old),
            None => self.attributes.push((name.to_owned(), value.to_owned())),
        }
    }

    /// Takes an attribute away.
    pub(crate) fn remove(&mut self, name: &str) {
        self.attributes.retain(|(key, _)| key != name);
    }
}

/// A tree; the root is the first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) elements: Vec<Element>,
    /// Children by name: nodes, inputs and outputs, which do not share their names.
    names: FxHashMap<(Id, String), Id>,
    inputs: FxHashMap<(Id, String), Id>,
    outputs: FxHashMap<(Id, String), Id>,
}

impl Tree {
    pub(crate) const ROOT: Id = Id(0);

    pub(crate) fn new() -> Self {
        Self {
            elements: vec![Element {
                tag: "materialx".to_owned(),
                ..Element::default()
            }],
            names: FxHashMap::default(),
            inputs: FxHashMap::default(),
            outputs: FxHashMap::default(),
        }
    }

    /// Another root, for what is no part of the document.
    pub(crate) fn add_root(&mut self) -> Id {
        let id = Id(u32::try_from(self.elements.len()).unwrap_or(u32::MAX));
        self.elements.push(Element::default());
        id
    }

    pub(crate) fn get(&self, id: Id) -> &Element {
        &self.elements[id.0 as usize]
    }

    pub(crate) fn get_mut(&mut self, id: Id) -> &mut Element {
        &mut self.elements[id.0 as usize]
    }

    /// Adds a child at the end.
    pub(crate) fn add(&mut self, parent: Id, mut element: Element) -> Id {
        let id = Id(u32::try_from(self.elements.len()).unwrap_or(u32::MAX));
        element.parent = Some(parent);
        if !element.name.is_empty() {
            // Of two children with one name, the first is meant.
            let names = match element.tag.as_str() {
                "input" => &mut self.inputs,
                "output" => &mut self.outputs,
                _ => &mut self.names,
            };
            names.entry((parent, element.name.clone())).or_insert(id);
        }
        self.elements.push(element);
        self.get_mut(parent).children.push(id);
        id
    }

    pub(crate) fn children(&self, id: Id) -> impl Iterator<Item = Id> + '_ {
        self.get(id).children.iter().copied()
    }

    /// The child of that name, a node before an input or output; a name may lack the namespace that
    /// the element has.
    pub(crate) fn child(&self, parent: Id, name: &str) -> Option<Id> {
        let key = (parent, name.to_owned());
        let found = [&self.names, &self.inputs, &self.outputs];
        if let Some(id) = found.iter().find_map(|names| names.get(&key)) {
            return Some(*id);
        }
        let namespace = self.get(parent).attribute("namespace")?;
        let name = format!("{namespace}:{name}");
        self.names.get(&(parent, name)).copied()
    }

    /// The child `<input name="…">`.
    pub(crate) fn input(&self, node: Id, name: &str) -> Option<Id> {
        self.inputs.get(&(node, name.to_owned())).copied()
    }

    /// The child `<output name="…">`.
    pub(crate) fn output(&self, graph: Id, name: &str) -> Option<Id> {
        self.outputs.get(&(graph, name.to_owned())).copied()
    }

    /// Gives an input another name.
    pub(crate) fn rename_input(&mut self, node: Id, id: Id, name: &str) {
        let old = std::mem::replace(&mut self.get_mut(id).name, name.to_owned());
        self.inputs.remove(&(node, old));
        self.inputs.insert((node, name.to_owned()), id);
    }

    /// Takes the children of an element away.
    pub(crate) fn clear(&mut self, id: Id) {
        for child in std::mem::take(&mut self.get_mut(id).children) {
            let name = self.get(child).name.clone();
            self.inputs.remove(&(id, name));
        }
    }

    /// The children of a kind.
    pub(crate) fn tagged<'a>(
        &'a self,
        parent: Id,
        tag: &'static str,
    ) -> impl Iterator<Item = Id> + 'a {
        self.children(parent)
            .filter(move |id| self.get(*id).tag == tag)
    }

    /// An attribute of an element or of what it stands in.
    pub(crate) fn inherited(&self, id: Id, attribute: &str) -> Option<&str> {
        let mut at = Some(id);
        while let Some(id) = at {
            let element = self.get(id);
            if let Some(value) = element.attribute(attribute) {
                return Some(value);
            }
            at = element.parent;
        }
        None
    }

    /// The path of names to an element.
    pub(crate) fn path(&self, id: Id) -> String {
        let mut names = Vec::new();
        let mut at = Some(id);
        while let Some(id) = at {
            let element = self.get(id);
            if element.parent.is_some() {
                names.push(if element.name.is_empty() {
                    element.tag.as_str()
                } else {
                    element.name.as_str()
                });
            }
            at = element.parent;
        }
        names
            .iter()
            .rev()
            .fold(String::new(), |path, name| path + "/" + name)
    }

    /// Where an element stands.
    pub(crate) fn place(&self, id: Id) -> Place {
        let element = self.get(id);
        Place {
            file: element.file,
            offset: element.offset,
            path: self.path(id),
        }
    }
}
