//! Puts a page that says how to build the real one where none was built, so that the
//! workspace can be built without Node.js.

use std::path::Path;

const NOT_BUILT: &str = "<!doctype html><meta charset=\"utf-8\"><title>Ground station</title>\
    <p>The page was not built. Build it with <code>cd web &amp;&amp; npm ci &amp;&amp; npm run \
    build</code>, then build fcc-ground again.</p>\n";

fn main() -> std::io::Result<()> {
    let folder = Path::new("../../web/dist");
    let index = folder.join("index.html");
    if !index.exists() {
        std::fs::create_dir_all(folder)?;
        std::fs::write(&index, NOT_BUILT)?;
    }
    println!("cargo::rerun-if-changed=../../web/dist");
    Ok(())
}
