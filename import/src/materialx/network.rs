//! A network of nodes, followed from what is asked for to what it comes from.
//!
//! Nothing recurses over the document: what is asked for waits on a stack until what it reads is
//! there. A functional nodegraph becomes a scope of its own wherever a node uses it.

mod call;
mod origin;

use super::definition::{Definition, Definitions};
use crate::build::{Builder, Refusal};
use crate::element::{Id, Tree};
use crate::place::Findings;
use crate::rule::{Expr, Rules};
use crate::value::Value;
use call::NodeCall;
use mipless_graph::{Diagnostic, NodeSpec, Type};
use origin::Origin;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;

/// How deep functional nodegraphs may use each other.
const DEEPEST: usize = 64;

/// How often functional nodegraphs may be used.
const MOST_SCOPES: usize = 100_000;

/// A nodegraph in use.
#[derive(Debug)]
struct Scope {
    graph: Id,
    /// The node that uses it, the scope where that stands, and its definition.
    user: Option<(usize, Id, Rc<Definition>)>,
    depth: usize,
    /// What its nodes are called after.
    prefix: String,
}

/// An output of a node in a scope.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Key {
    scope: usize,
    node: Id,
    output: Rc<str>,
}

/// What a node becomes.
#[derive(Clone, Debug)]
enum Plan {
    /// Nodes of the catalogue, by a rule or by name.
    Nodes(Rc<Definition>),
    /// What a nodegraph gives.
    Graph(Rc<Definition>, Id),
    /// Nothing, for this reason.
    Refused(Refusal),
}

/// The code of a failure that was told where it began.
const CONSEQUENCE: &str = "import-consequence";

fn consequence() -> Refusal {
    Refusal::new(CONSEQUENCE, "")
}

/// Reads documents into a tree, below a root of their own.
type Load<'a> = Box<dyn FnMut(&mut Tree, &mut Findings) -> Option<Id> + 'a>;

/// What the network is made of beside the document.
pub(crate) struct Library<'a> {
    /// Reads MaterialX's own documents.
    pub(crate) load: Load<'a>,
    loaded: Option<Option<(Id, Definitions)>>,
}

impl<'a> Library<'a> {
    pub(crate) fn new(load: impl FnMut(&mut Tree, &mut Findings) -> Option<Id> + 'a) -> Self {
        Self {
            load: Box::new(load),
            loaded: None,
        }
    }
}

/// A network.
pub(crate) struct Network<'a> {
    pub(crate) tree: Tree,
    pub(crate) findings: Findings,
    own: Definitions,
    library: Library<'a>,
    rules: &'static Rules,
    /// The nodes of the catalogue.
    known: FxHashSet<String>,
    scopes: Vec<Scope>,
    /// Scopes by where they are used.
    inner: FxHashMap<(usize, Id), usize>,
    outer: FxHashMap<Id, usize>,
    plans: FxHashMap<Id, Plan>,
    /// What definitions of documents are made of, by where they stand and their names.
    implementations: FxHashMap<(Id, String), Plan>,
    done: FxHashMap<Key, Result<Value, ()>>,
    /// Inputs of the graph by the elements that declare them.
    pub(super) inputs: FxHashMap<Id, String>,
    /// Whether names of nodes begin with that of their nodegraph.
    pub(super) prefixed: bool,
}

impl<'a> Network<'a> {
    pub(crate) fn new(
        tree: Tree,
        findings: Findings,
        rules: &'static Rules,
        library: Library<'a>,
        specs: &[&'static NodeSpec],
    ) -> Self {
        let own = Definitions::of(&tree, Tree::ROOT);
        let prefixed = tree.tagged(Tree::ROOT, "nodegraph").count() > 1;
        Self {
            tree,
            findings,
            own,
            library,
            rules,
            known: specs.iter().map(|spec| spec.name.to_owned()).collect(),
            scopes: Vec::new(),
            inner: FxHashMap::default(),
            outer: FxHashMap::default(),
            plans: FxHashMap::default(),
            implementations: FxHashMap::default(),
            done: FxHashMap::default(),
            inputs: FxHashMap::default(),
            prefixed,
        }
    }

    /// The scope of a nodegraph that stands in the document, or of the document.
    pub(crate) fn scope_of(&mut self, graph: Id) -> usize {
        if let Some(scope) = self.outer.get(&graph) {
            return *scope;
        }
        let prefix = if graph == Tree::ROOT || !self.prefixed {
            String::new()
        } else {
            format!("{}_", self.tree.get(graph).name)
        };
        self.scopes.push(Scope {
            graph,
            user: None,
            depth: 0,
            prefix,
        });
        self.outer.insert(graph, self.scopes.len() - 1);
        self.scopes.len() - 1
    }

    /// The scope of a functional nodegraph where a node uses it.
    fn scope_in(
        &mut self,
        scope: usize,
        node: Id,
        graph: Id,
        definition: &Rc<Definition>,
    ) -> Result<usize, Refusal> {
        if let Some(inner) = self.inner.get(&(scope, node)) {
            return Ok(*inner);
        }
        // The nodegraphs around the node: one that is among them never ends, and branches on its way.
        let mut around = Some(scope);
        while let Some(outer) = around {
            let Scope {
                graph: of, user, ..
            } = &self.scopes[outer];
            if *of == graph {
                let message = format!("nodegraph `{}` uses itself", self.tree.get(graph).name);
                return Err(Refusal::new("import-circle", message));
            }
            around = user.as_ref().map(|(outer, ..)| *outer);
        }
        let depth = self.scopes[scope].depth + 1;
        if depth > DEEPEST {
            let message = format!("nodegraphs use each other more than {DEEPEST} deep");
            return Err(Refusal::new("import-limit", message));
        }
        if self.scopes.len() >= MOST_SCOPES {
            let message = format!("nodegraphs are used more than {MOST_SCOPES} times");
            return Err(Refusal::new("import-limit", message));
        }
        let prefix = format!("{}{}_", self.scopes[scope].prefix, self.tree.get(node).name);
        self.scopes.push(Scope {
            graph,
            user: Some((scope, node, Rc::clone(definition))),
            depth,
            prefix,
        });
        self.inner.insert((scope, node), self.scopes.len() - 1);
        Ok(self.scopes.len() - 1)
    }

    /// Says why something at an element does not load.
    fn refuse(&mut self, at: Id, refusal: &Refusal) {
        if refusal.code == CONSEQUENCE {
            return;
        }
        let place = self.tree.place(at);
        let element = self.tree.get(at);
        let message = match element.tag.as_str() {
            "input" | "output" | "nodegraph" | "materialx" => refusal.message.clone(),
            tag => format!("MaterialX node `{tag}`: {}", refusal.message),
        };
        self.findings
            .say(&place, Diagnostic::error(refusal.code, message));
    }

    /// What the input or output `element` of the scope holds, as the type that it says. What it
    /// reads is made first.
    pub(crate) fn value(
        &mut self,
        builder: &mut Builder,
        scope: usize,
        element: Id,
    ) -> Result<Value, ()> {
        let origin = self.follow(scope, element, None);
        if let Origin::Node(key) = &origin {
            self.make(builder, key.clone());
        }
        let ty = self
            .tree
            .get(element)
            .attribute("type")
            .unwrap_or("")
            .to_owned();
        builder.place = Some(self.tree.place(element));
        builder.hint.clone_from(&self.tree.get(element).name);
        let value = self.of_origin(builder, origin, &ty);
        let value = value.and_then(|value| match Type::by_name(&ty) {
            Some(ty) => builder.converted(value, ty),
            None => Ok(value),
        });
        self.tell_notes(builder, element);
        value.map_err(|refusal| self.refuse(element, &refusal))
    }

    /// What an input or output shows: the output of a nodegraph that it reads, or itself.
    pub(crate) fn source_of(&self, scope: usize, element: Id) -> String {
        let at = self.tree.get(element);
        let graph = at.attribute("nodegraph").or_else(|| {
            let node = at.attribute("nodename")?;
            let id = self.tree.child(self.scopes[scope].graph, node)?;
            (self.tree.get(id).tag == "nodegraph").then_some(node)
        });
        let read = graph
            .and_then(|graph| self.tree.child(Tree::ROOT, graph))
            .and_then(|graph| self.graph_output(graph, at.attribute("output").unwrap_or("")));
        self.tree
            .path(read.unwrap_or(element))
            .trim_start_matches('/')
            .to_owned()
    }

    /// Makes an output of a node, and all that it reads.
    fn make(&mut self, builder: &mut Builder, wanted: Key) {
        let mut stack = vec![wanted];
        let mut open: FxHashSet<Key> = FxHashSet::default();
        while let Some(key) = stack.last().cloned() {
            if self.done.contains_key(&key) {
                stack.pop();
                open.remove(&key);
                continue;
            }
            if open.insert(key.clone()) {
                let missing: Vec<Key> = (self.reads(&key).into_iter())
                    .filter(|read| !self.done.contains_key(read))
                    .collect();
                if let Some(circle) = missing.iter().find(|read| open.contains(read)) {
                    let message = "it reads what it gives: nodes go in a circle";
                    self.refuse(circle.node, &Refusal::new("import-circle", message));
                    self.done.insert(key, Err(()));
                    continue;
                }
                if !missing.is_empty() {
                    stack.extend(missing);
                    continue;
                }
            }
            let value = self.finish(builder, &key);
            let value = value.map_err(|refusal| self.refuse(key.node, &refusal));
            self.done.insert(key, value);
        }
    }

    /// The outputs of other nodes that an output of a node reads.
    fn reads(&mut self, key: &Key) -> Vec<Key> {
        match self.plan(key.node) {
            Plan::Refused(_) => Vec::new(),
            Plan::Graph(definition, graph) => {
                let inner = self.scope_in(key.scope, key.node, graph, &definition);
                let output = inner.ok().and_then(|inner| {
                    let output = self.graph_output(graph, &key.output)?;
                    Some(self.follow(inner, output, None))
                });
                match output {
                    Some(Origin::Node(key)) => vec![key],
                    _ => Vec::new(),
                }
            }
            Plan::Nodes(definition) => {
                let inputs = definition.inputs.iter();
                inputs
                    .filter_map(|input| {
                        match self.origin(key.scope, key.node, &definition, &input.name) {
                            Origin::Node(key) => Some(key),
                            _ => None,
                        }
                    })
                    .collect()
            }
        }
    }

    /// The output of a nodegraph by name, or its first where none is named.
    pub(crate) fn graph_output(&self, graph: Id, name: &str) -> Option<Id> {
        let only = || self.tree.tagged(graph, "output").next();
        let unnamed = name == "out" || name.is_empty();
        self.tree
            .output(graph, name)
            .or_else(|| if unnamed { only() } else { None })
    }

    /// An output of a node whose inputs are there.
    fn finish(&mut self, builder: &mut Builder, key: &Key) -> Result<Value, Refusal> {
        builder.place = Some(self.tree.place(key.node));
        builder.hint = format!(
            "{}{}",
            self.scopes[key.scope].prefix,
            self.tree.get(key.node).name
        )
        .replace([':', '/'], "_");
        match self.plan(key.node) {
            Plan::Refused(refusal) => Err(refusal),
            Plan::Graph(definition, graph) => {
                let inner = self.scope_in(key.scope, key.node, graph, &definition)?;
                let output = self.graph_output(graph, &key.output).ok_or_else(|| {
                    let message = format!(
                        "its nodegraph `{}` has no output `{}`",
                        self.tree.get(graph).name,
                        key.output
                    );
                    Refusal::new("import-reference", message)
                })?;
                let origin = self.follow(inner, output, None);
                let ty = (definition.output(&key.output)).map_or("", |(_, ty)| ty);
                let value = self.of_origin(builder, origin, ty)?;
                match Type::by_name(ty) {
                    Some(ty) => builder.converted(value, ty),
                    None => Ok(value),
                }
            }
            Plan::Nodes(definition) => {
                let (output, ty) = match definition.output(&key.output) {
                    Some((output, ty)) => (output.to_owned(), ty.to_owned()),
                    None => {
                        let message = format!("it has no output `{}`", key.output);
                        return Err(Refusal::new("import-reference", message));
                    }
                };
                let rules = self.rules;
                let rule = rule_of(rules, &definition);
                let mut call = NodeCall::new(self, key, &definition, &output, &ty);
                let value = match rule {
                    Some(rule) => crate::eval::eval(rule, builder, &mut call),
                    None => call.same_name(builder),
                };
                let value = value.and_then(|value| match Type::by_name(&ty) {
                    Some(ty) => builder.converted(value, ty),
                    None => Ok(value),
                });
                self.tell_notes(builder, key.node);
                value
            }
        }
    }

    /// Says what was approximated at an element.
    fn tell_notes(&mut self, builder: &mut Builder, at: Id) {
        for note in std::mem::take(&mut builder.notes) {
            let place = self.tree.place(at);
            let note = Diagnostic::note("import-approximated", note);
            self.findings.say(&place, note);
        }
    }

    /// What a node becomes; found once.
    fn plan(&mut self, node: Id) -> Plan {
        if let Some(plan) = self.plans.get(&node) {
            return plan.clone();
        }
        let plan = self.find_plan(node).unwrap_or_else(Plan::Refused);
        self.plans.insert(node, plan.clone());
        plan
    }

    fn find_plan(&mut self, node: Id) -> Result<Plan, Refusal> {
        let own = find(&self.own, &self.tree, node).cloned();
        if let Some(definition) = own {
            return Ok(self.implemented(definition, Tree::ROOT));
        }
        let standard = find(Definitions::standard(), &self.tree, node).cloned();
        let Some(definition) = standard else {
            // A node of one of MaterialX's libraries that are no part of the table.
            if let Some((root, definition)) = self.in_library(node) {
                return Ok(self.implemented(definition, root));
            }
            let element = self.tree.get(node);
            let known = self.own.knows(&element.tag) || Definitions::standard().knows(&element.tag);
            let ty = element.attribute("type").unwrap_or("");
            return Err(if known {
                let message = format!("there is none of the type `{ty}`");
                Refusal::new("import-node-missing", message)
            } else {
                let message = "neither MaterialX's standard nodes nor the document define it; \
                               `--library` names the folder of what does";
                Refusal::new("import-node-missing", message)
            });
        };
        let ruled = [&definition.name, &definition.node];
        if self.known.contains(&definition.node)
            || ruled.iter().any(|name| self.rules.get(name).is_some())
        {
            return Ok(Plan::Nodes(Rc::new(definition)));
        }
        // A node that is not here may be made of others in MaterialX's own documents.
        match self.in_library(node) {
            Some((root, definition)) => Ok(self.implemented(definition, root)),
            None => Ok(Plan::Nodes(Rc::new(definition))),
        }
    }

    /// What a definition is made of; found once.
    fn implemented(&mut self, definition: Definition, root: Id) -> Plan {
        let key = (root, definition.name.clone());
        if let Some(plan) = self.implementations.get(&key) {
            return plan.clone();
        }
        let plan = self
            .implementation(definition, root)
            .unwrap_or_else(Plan::Refused);
        self.implementations.insert(key, plan.clone());
        plan
    }

    /// What a definition of a document, or of a library, is made of.
    fn implementation(&self, definition: Definition, root: Id) -> Result<Plan, Refusal> {
        let tree = &self.tree;
        let is_it = |id: &Id| tree.get(*id).attribute("nodedef") == Some(&definition.name);
        if let Some(graph) = tree.tagged(root, "nodegraph").find(is_it) {
            return Ok(Plan::Graph(Rc::new(definition), graph));
        }
        let mut foreign = None;
        for id in tree.tagged(root, "implementation").filter(is_it) {
            let implementation = tree.get(id);
            let graph = implementation.attribute("nodegraph");
            if let Some(graph) = graph.and_then(|graph| tree.child(root, graph)) {
                return Ok(Plan::Graph(Rc::new(definition), graph));
            }
            foreign = foreign.or(Some(implementation));
        }
        if Definitions::standard().named(&definition.name).is_some() {
            return Ok(Plan::Nodes(Rc::new(definition)));
        }
        Err(match foreign {
            Some(implementation) => {
                let target = implementation.attribute("target").unwrap_or("some target");
                let file = implementation.attribute("file");
                let what = file.map_or("source code".to_owned(), |file| {
                    format!("the file `{file}`")
                });
                let message = format!("it is {what} for {target}, which is not run here");
                Refusal::new("import-foreign-code", message)
            }
            None => {
                let message = format!("`{}` has no implementation", definition.name);
                Refusal::new("import-node-missing", message)
            }
        })
    }

    /// The definition of a node in MaterialX's own documents, if they are at hand.
    fn in_library(&mut self, node: Id) -> Option<(Id, Definition)> {
        let library = &mut self.library;
        let loaded = library.loaded.get_or_insert_with(|| {
            let root = (library.load)(&mut self.tree, &mut self.findings)?;
            let definitions = Definitions::of(&self.tree, root);
            Some((root, definitions))
        });
        let (root, definitions) = loaded.as_ref()?;
        let definition = find(definitions, &self.tree, node)?.clone();
        Some((*root, definition))
    }
}

/// The rule of a definition, or of its node.
fn rule_of<'r>(rules: &'r Rules, definition: &Definition) -> Option<&'r Expr> {
    (rules.get(&definition.name)).or_else(|| rules.get(&definition.node))
}

/// The definition that a node means.
fn find<'d>(definitions: &'d Definitions, tree: &Tree, node: Id) -> Option<&'d Definition> {
    let element = tree.get(node);
    if let Some(named) = element.attribute("nodedef")
        && let Some(definition) = definitions.named(named)
    {
        return Some(definition);
    }
    let inputs: Vec<(&str, &str)> = (tree.tagged(node, "input"))
        .map(|input| {
            let input = tree.get(input);
            (input.name.as_str(), input.attribute("type").unwrap_or(""))
        })
        .collect();
    let ty = element.attribute("type").unwrap_or("");
    let version = element.attribute("version");
    let of = |category: &str| definitions.of_node(category, ty, version, &inputs);
    // A category may have a namespace that its definition says apart.
    of(&element.tag).or_else(|| of(element.tag.rsplit_once(':')?.1))
}
