//! The header says what the sources say.

use std::path::Path;

/// The header as the sources have it now.
fn written() -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in
        ["code", "catalogue", "calls/values", "calls/catalogue", "calls/model", "calls/observer"]
    {
        builder = builder.with_src(here.join("src").join(file).with_extension("rs"));
    }
    let mut bytes = Vec::new();
    builder.generate().unwrap().write(&mut bytes);
    String::from_utf8(bytes).unwrap()
}

/// `UPDATE_HEADER=1 cargo test -p friction_c --test header` writes it anew.
#[test]
fn the_header_is_that_of_the_sources() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/friction.h");
    let written = written();
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(&file, &written).unwrap();
    }
    let committed = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        committed == written,
        "include/friction.h is not that of the sources; write it anew by \
         `UPDATE_HEADER=1 cargo test -p friction_c --test header`"
    );
}

/// A function that is exported and not in the header would be found by nobody.
#[test]
fn every_exported_function_is_in_the_header() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let written = written();
    let mut count = 0;
    for file in std::fs::read_dir(here.join("src/calls")).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        for line in text.lines() {
            if let Some((_, after)) = line.split_once("extern \"C\" fn ") {
                let name = after.split('(').next().unwrap();
                assert!(written.contains(&format!("{name}(")), "{name}");
                count += 1;
            }
        }
    }
    assert!(count >= 20, "{count}");
}
