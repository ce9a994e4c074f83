//! Builds the parsers from the grammars.

fn main() {
    println!("cargo:rerun-if-changed=src/stl/stl.lalrpop");
    println!("cargo:rerun-if-changed=src/scl/scl.lalrpop");
    println!("cargo:rerun-if-changed=src/s7200/s7200.lalrpop");
    lalrpop::Configuration::new()
        .use_cargo_dir_conventions()
        .emit_rerun_directives(false)
        .process()
        .expect("the grammar is right; the message above tells what is not");
}
