//! Compiles the schemas in `proto/foxglove` without a protoc: into Rust types, and into
//! the descriptors that each recording carries.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use prost::Message as _;

const PROTO: &str = "proto";

/// The file of each topic's schema, and what its descriptors are called here.
const SCHEMAS: [(&str, &str); 3] = [
    ("foxglove/LocationFix.proto", "location_fix"),
    ("foxglove/FrameTransform.proto", "frame_transform"),
    ("foxglove/Log.proto", "log"),
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={PROTO}");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo did not say where to write")?);
    for (file, name) in SCHEMAS {
        let mut compiler = protox::Compiler::new([PROTO])?;
        // A reader needs the fields of what is imported, and no comments.
        compiler.include_imports(true).include_source_info(false);
        compiler.open_file(file)?;
        let descriptors = compiler.file_descriptor_set();
        fs::write(out.join(format!("{name}.fds")), descriptors.encode_to_vec())?;
    }
    let all = protox::compile(SCHEMAS.map(|(file, _)| file), [PROTO])?;
    prost_build::Config::new().compile_fds(all)?;
    Ok(())
}
