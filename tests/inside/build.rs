//! Builds the parsers from the grammars.

fn main() {
    for library in ["compiler/syntax", "compiler/readers"] {
        let sources = format!("../../{library}/src");
        println!("cargo:rerun-if-changed={sources}");
        lalrpop::Configuration::new()
            .set_in_dir(sources)
            .set_out_dir(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"))
            .emit_rerun_directives(false)
            .process()
            .expect("the grammar is right; the message above tells what is not");
    }
}
