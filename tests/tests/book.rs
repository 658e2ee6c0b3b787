//! The generated pages and pictures of the book are those of the catalogue. `bash .ci/fresh` makes
//! them fresh.

use mipless_runtime::image::Image;
use mipless_runtime::image_file::{self, Bits, Format, Space};
use mipless_tests::book::{PAGES, index, page, summary, thumbnails};
use mipless_tests::generated::{FRESH, compare, names};
use mipless_tests::{asked, root, thumbnail};
use rayon::prelude::*;
use std::fs;
use std::path::Path;

const SUMMARY: &str = "docs/book/src/SUMMARY.md";

#[test]
fn the_pages_of_the_nodes_are_fresh() {
    let mut wanted = vec!["index.md".to_owned()];
    let mut stale = Vec::new();
    stale.extend(compare(&format!("{PAGES}/index.md"), &index()).err());
    for def in mipless::catalogue() {
        let name = format!("{}.md", def.spec.name);
        stale.extend(compare(&format!("{PAGES}/{name}"), &page(def)).err());
        wanted.push(name);
    }
    let held = names(&root().join(PAGES), ".md");
    stale.extend(held.into_iter().filter(|name| !wanted.contains(name)));
    assert!(stale.is_empty(), "{}", stale.join("\n"));
}

#[test]
fn the_table_of_contents_lists_every_node() {
    let held = fs::read_to_string(root().join(SUMMARY)).expect("the book has a table of contents");
    let wanted = summary(&held).unwrap_or_else(|error| panic!("{error}"));
    compare(SUMMARY, &wanted).unwrap_or_else(|error| panic!("{error}"));
}

/// The bytes of a picture in the form in which `render` writes it.
fn encoded(path: &Path, image: &Image) -> Vec<u8> {
    image_file::encode(path, image, Format::Png(Bits::Eight, Space::Srgb)).expect("a picture")
}

/// The pixels of a picture's bytes, a byte a channel.
fn pixels(png: &[u8]) -> Option<image::RgbaImage> {
    Some(image::load_from_memory(png).ok()?.to_rgba8())
}

/// By how many 255ths two pictures differ at most; by all of them where they are not alike at all.
fn apart(held: &[u8], wanted: &[u8]) -> u8 {
    let (Some(held), Some(wanted)) = (pixels(held), pixels(wanted)) else {
        return u8::MAX;
    };
    if held.dimensions() != wanted.dimensions() {
        return u8::MAX;
    }
    let pairs = held.as_raw().iter().zip(wanted.as_raw());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn the_pictures_of_the_nodes_are_what_is_rendered() {
    let folder = root().join(PAGES);
    if asked("MIPLESS_WRITE") {
        fs::create_dir_all(folder.join("thumbnails")).expect("a folder for the thumbnails");
    }
    let nodes: Vec<_> = mipless::catalogue().iter().collect();
    let mut stale: Vec<String> = (nodes.par_iter())
        .flat_map_iter(|def| {
            let rendered = thumbnail::render(def);
            let held = thumbnails(def.spec.name).into_iter().zip(rendered);
            held.filter_map(|(name, image)| {
                let path = folder.join(&name);
                let wanted = encoded(&path, &image);
                let difference = apart(&fs::read(&path).unwrap_or_default(), &wanted);
                if difference <= 1 {
                    return None;
                }
                if asked("MIPLESS_WRITE") {
                    fs::write(&path, wanted).expect("the picture is written");
                    return None;
                }
                Some(format!("{name} is off by {difference}/255: {FRESH}"))
            })
            .collect::<Vec<_>>()
        })
        .collect();
    let wanted: Vec<String> = (nodes.iter())
        .flat_map(|def| thumbnails(def.spec.name))
        .collect();
    let held = names(&folder.join("thumbnails"), "");
    let held = held.into_iter().map(|name| format!("thumbnails/{name}"));
    stale.extend(
        held.filter(|name| !wanted.contains(name))
            .map(|name| format!("{name} belongs to no node")),
    );
    assert!(stale.is_empty(), "{}", stale.join("\n"));
}
