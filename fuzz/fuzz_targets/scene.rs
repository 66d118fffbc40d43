//! Arbitrary text as a scene.
#![no_main]

use std::path::Path;

use graintwin::scene;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let file = Path::new("fuzz.yaml");
    if let Ok(scene) = scene::parse(text, file) {
        let echo = scene.to_yaml().expect("a valid scene can be written");
        let again = scene::parse(&echo, file).expect("what was written is valid");
        assert_eq!(again.to_yaml().expect("a valid scene can be written"), echo);
    }
});
