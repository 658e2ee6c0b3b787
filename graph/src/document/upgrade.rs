//! Older versions, made into the present one by steps from each version to the next. A step changes
//! JSON and knows nothing of nodes, so that it never needs to change again.

use super::tree::{Json, Member, Tree};

/// Turns a document of version `n` into one of version `n + 1`, where `n` is its position.
type Step = fn(&mut Tree);

/// The steps; as many as the present version.
const STEPS: [Step; super::VERSION as usize] = [nodes_have_inputs];

/// Upgrades a document of that version, which is not above the present one.
pub(super) fn upgrade(tree: &mut Tree, version: u64) {
    for step in STEPS
        .iter()
        .skip(usize::try_from(version).unwrap_or(usize::MAX))
    {
        step(tree);
    }
}

/// Version 0 (drafts before the first release) had literals and connections of a node under
/// `params`; version 1 says `inputs`, as MaterialX does.
fn nodes_have_inputs(tree: &mut Tree) {
    rename(tree);
    for graph in values(tree, "graphs") {
        rename(graph);
    }

    fn rename(body: &mut Tree) {
        for node in values(body, "nodes") {
            let Json::Object(members) = &mut node.value else {
                continue;
            };
            for member in members {
                if member.key == "params" {
                    "inputs".clone_into(&mut member.key);
                }
            }
        }
    }
}

/// The values of the object under that key; nothing where the document is not of that shape, which
/// the reader reports.
fn values<'t>(tree: &'t mut Tree, key: &'t str) -> impl Iterator<Item = &'t mut Tree> {
    let outer = members(tree)
        .iter_mut()
        .filter(move |member| member.key == key);
    outer
        .flat_map(|member| members(&mut member.tree))
        .map(|member| &mut member.tree)
}

fn members(tree: &mut Tree) -> &mut [Member] {
    match &mut tree.value {
        Json::Object(members) => members,
        _ => &mut [],
    }
}

#[cfg(test)]
mod tests {
    use crate::Document;

    #[test]
    fn version_0_becomes_version_1() {
        let (old, mistakes) = Document::parse(include_str!("upgrade/version_0.json"));
        assert_eq!(mistakes, []);
        let (new, mistakes) = Document::parse(include_str!("upgrade/version_0_as_1.json"));
        assert_eq!(mistakes, []);
        assert_eq!(old, new);
        assert_eq!(old.expect("a document").to_json()["version"], 1);
    }
}
