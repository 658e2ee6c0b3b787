//! Every source has a page with its mean, variance, range and spectrum, and the accuracy that a test
//! holds.

use mipless_graph::Category;
use mipless_tests::root;

#[test]
fn the_pages_of_sources_state_their_statistics_and_the_test_that_holds_them() {
    let root = root();
    let sources: Vec<_> = (mipless_nodes::specs().into_iter())
        .filter(|spec| spec.category == Category::Noise || spec.name == "image")
        .collect();
    assert!(sources.len() >= 16, "{} sources", sources.len());
    for spec in sources {
        let (name, statistics) = (spec.name, spec.doc.statistics.to_lowercase());
        for words in [
            &["mean"][..],
            &["variance", "standard deviation"],
            &["range"],
            &["spectrum"],
        ] {
            assert!(
                words.iter().any(|word| statistics.contains(word)),
                "{name}: the page states no {words:?}"
            );
        }
        let held: Vec<_> = (spec.doc.accuracy.split('`'))
            .filter(|text| text.ends_with(".rs"))
            .collect();
        assert!(!held.is_empty(), "{name}: the page names no test");
        for file in held {
            assert!(root.join(file).is_file(), "{name}: {file} does not exist");
        }
    }
}
