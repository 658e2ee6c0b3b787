//! Text is a graph, or mistakes that say where they are and what.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mipless::Texture;

fuzz_target!(|text: &str| {
    if let Err(mistakes) = Texture::from_json(text) {
        assert!(!mistakes.is_empty(), "refused without a reason");
        for mistake in mistakes {
            let is_placed = mistake.line.is_some() || mistake.pointer.is_some();
            assert!(is_placed, "{mistake} stands nowhere");
            assert!(!mistake.message.is_empty(), "{} is mute", mistake.code);
        }
    }
});
