//! Builds the parsers from the grammars.

fn main() {
    println!("cargo:rerun-if-changed=src/sd/sd.lalrpop");
    println!("cargo:rerun-if-changed=src/gr7/gr7.lalrpop");
    lalrpop::Configuration::new()
        .use_cargo_dir_conventions()
        .emit_rerun_directives(false)
        .process()
        .expect("the grammar is right; the message above tells what is not");
}
