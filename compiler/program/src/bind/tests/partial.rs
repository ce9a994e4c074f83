//! Partial programs: a name that is defined nowhere is one warning, and parts that depend on it are not checked.

use plcc_abi::image::Family;
use plcc_diag::{SourceFile, SourceMap};
use plcc_readers::ReadOptions;
use plcc_syntax::Language;

use crate::bind::bind;
use crate::bind::declarations::shipped::empty;
use plcc_binding::BindInput;
use plcc_model::profile;

/// The messages about a part of a program in `language`, as code and title.
#[track_caller]
fn messages(language: Language, source: &str) -> Vec<String> {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("part", source));
    let options = ReadOptions { language: Some(language), ..ReadOptions::default() };
    let (unit, mut diagnostics) = plcc_readers::parse(file, source, &options);
    let (_, bound) = bind(&BindInput {
        name: "part".to_string(),
        units: &[(file, unit)],
        profile: plcc_abi::image::Profile { limits_checked: false, ..profile::generic(Family::S7300) },
        partial: true,
        ..empty(&sources)
    });
    diagnostics.extend(bound);
    assert!(!diagnostics.iter().any(plcc_diag::Diagnostic::is_error), "{diagnostics:#?}");
    diagnostics.iter().map(|message| format!("{} {}", message.code.name(), message.title)).collect()
}

#[test]
fn constants_of_tag_tables_may_be_missing() {
    let source = r#"
TYPE "Recipe"
   STRUCT
      steps : Array[1.."STEPS_MAX"] of Int;
      text : String["TEXT_LENGTH"];
      first : Int := "FIRST";
   END_STRUCT;
END_TYPE
FUNCTION "F" : Int
   VAR_INPUT
      mode : Int;
   END_VAR
   VAR_IN_OUT
      recipe : "Recipe";
   END_VAR
BEGIN
   CASE #mode OF
      "MODE_OFF":
         #F := 0;
      "MODE_AUTO", 5.."MODE_LAST":
         #F := #recipe.steps["STEPS_MAX"];
   END_CASE;
END_FUNCTION
"#;
    let expected = ["STEPS_MAX", "TEXT_LENGTH", "FIRST", "MODE_OFF", "MODE_AUTO", "MODE_LAST"];
    let expected: Vec<String> =
        expected.iter().map(|name| format!("P0402 the constant `{name}` is not defined")).collect();
    assert_eq!(messages(Language::Scl, source), expected);
}

#[test]
fn a_quoted_name_is_no_local() {
    let source = r#"
FUNCTION_BLOCK "Line"
   VAR
      motor : Struct
         on : Bool;
      END_STRUCT;
      speed : Int;
      LIMIT : Int;
   END_VAR
BEGIN
   "motor"(start := TRUE, speed => #speed);
   #speed := "speed";
   #motor.on := "motor".running;
   "LIMIT"(top := 5);
END_FUNCTION_BLOCK
"#;
    let expected = [
        "P0302 the block `motor` is not defined",
        "P0301 the symbol `speed` is not defined",
        "P0302 the block `LIMIT` is not defined",
    ];
    assert_eq!(messages(Language::Scl, source), expected);
}

#[test]
fn blocks_by_names_of_library_blocks_are_those_of_the_program() {
    let source = r#"
FUNCTION "F" : Real
   VAR_INPUT
      raw : Int;
   END_VAR
BEGIN
   #F := "SCALE"(value := #raw, top := 100.0);
END_FUNCTION
"#;
    assert_eq!(messages(Language::Scl, source), ["P0302 the block `SCALE` is not defined"]);
    let source = "FUNCTION FC 50 : VOID\nBEGIN\n      CALL  FC     1\n       start := M 1.0\n       speed := MW 10\nEND_FUNCTION\n";
    assert_eq!(messages(Language::Stl, source), ["P0302 FC 1 is not defined"]);
}

#[test]
fn networks_may_be_drafts() {
    let source = r#"
{ S7_PreferredLanguage := "LAD"; S7_Optimized := "TRUE" }
FUNCTION_BLOCK "Draft"
    VAR_INPUT
        start : Bool;
    END_VAR
    VAR_OUTPUT
        run : Bool;
    END_VAR
    NETWORK
        RUNG wire#powerrail Contact( #start ) END_RUNG
    END_NETWORK
    NETWORK
        RUNG wire#powerrail Contact( #start ) Coil() END_RUNG
    END_NETWORK
    NETWORK
        RUNG wire#powerrail Contact( #start ) Coil( #run ) END_RUNG
    END_NETWORK
END_FUNCTION_BLOCK
"#;
    let found = messages(Language::Sd, source);
    assert_eq!(found.len(), 2, "{found:#?}");
}
