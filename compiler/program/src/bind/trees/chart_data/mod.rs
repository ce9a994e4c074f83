//! Data of a chart in the instance of its block: declarations that every language can name, and their addresses.
//! Source: GRAPH reference, chapter F.

use plcc_diag::Span;
use plcc_model::types::DataType;
use plcc_syntax::ParseOptions;
use plcc_syntax::ast::{self, InitialKind, InitialValue, Section, SectionKind, TypeKind, TypeRef, Variable};
use plcc_syntax::chart::ast::{Body as Chart, Dialect, Settings, StepData};
use plcc_syntax::chart::parameters::{self, OPERATING_BITS};
use plcc_syntax::scl;
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal};
use rustc_hash::FxHashSet;

use crate::bind::trees::SYSTEM_FILE;
use plcc_binding::fold;

/// Components of a step, as S7-GRAPH of STEP 7 V5 lays them out.
const STEP: &str = "S1, L1, V1, R1, A1, S0, L0, V0, X, LA, VA, RA, AA, SS, LS, VS : BOOL; SNO : INT; T, U : TIME;
    CRIT_LOC, CRIT_LOC_ERR, CRIT_SUP : DWORD; SM, LP, LN, VP, VN : BOOL; H_IL_ERR, H_SV_FLT : BYTE; RESERVE : DWORD;";

/// Components of a step in the TIA Portal.
const TIA_STEP: &str = "S1, L1, V1, R1, A1, S0, L0, V0, X, LA, VA, RA, AA, SS, LS, VS : BOOL; SNO : INT; T, U : TIME;
    T_MAX : TIME := T#10s; T_WARN : TIME := T#7s; CRIT_LOC, CRIT_LOC_ERR : DWORD; SM : BOOL; H_IL_ERR, H_SV_FLT : BYTE;";

/// Components of a transition.
const TRANSITION: &str = "TV, TT, TS, CF_IV : BOOL; TNO : INT; CRIT, CRIT_OLD, CRIT_FLT : DWORD;";

/// Bits of MOP that are 1 in a new instance.
const START_VALUES: [&str; 6] = ["AUTO", "LOCK", "SUP", "ACKREQ", "INIT", "SACT_DISP"];

/// Structure around the data of the engine in the TIA Portal.
pub const TIA_DATA: &str = "RT_DATA";

/// Names of the components of the instance that hold steps and transitions, in their order. If the block declares a name as something
/// else, it keeps it; the step then has its number as a name.
pub struct Members {
    pub steps: Vec<String>,
    pub transitions: Vec<String>,
    /// The arrays G7S and G7T hold them.
    pub arrays: bool,
}

impl Members {
    pub fn new(block: &ast::CodeBlock, chart: &Chart) -> Members {
        let mut taken: FxHashSet<String> = declared(block).map(|variable| fold(&variable.name)).collect();
        taken.extend(parameters::PARAMETERS.iter().map(|parameter| fold(parameter.name)));
        taken.extend(ENGINE_NAMES.iter().map(|name| fold(name)));
        let mut name = |name: &str, letter: char, number: u32, at: usize| {
            let others = [format!("{letter}{number:03}"), format!("{letter}_{}", at + 1)];
            let free = [name.to_string()].into_iter().chain(others).find(|name| taken.insert(fold(name)));
            free.unwrap_or_else(|| format!("{letter}__{}", at + 1))
        };
        let transitions = chart.transitions.iter().enumerate();
        let transitions = transitions.map(|(at, one)| name(&one.name.text, 'T', one.number, at)).collect();
        let steps = chart.steps.iter().enumerate();
        let steps = steps.map(|(at, one)| name(&one.name.text, 'S', one.number, at)).collect();
        Members { steps, transitions, arrays: chart.settings.data == Some(StepData::Array) }
    }
}

/// Variables that the source declares, without those that [`expanded`] adds.
fn declared(block: &ast::CodeBlock) -> impl Iterator<Item = &Variable> {
    block
        .sections
        .iter()
        .flat_map(|section| &section.variables)
        .filter(|variable| variable.name_span.file != SYSTEM_FILE)
}

/// Names of the engine's variables.
const ENGINE_NAMES: [&str; 10] = ["G7S", "G7T", "SAX", "S0X", "S1X", "MOPEDGE", "MOP", "SQ_FLAGS", "G7_DATA", TIA_DATA];

/// Whether the block declares a name that the chart needs for its data, which is reported with the declarations.
pub fn clashes(block: &ast::CodeBlock, chart: &Chart) -> bool {
    let arrays = chart.settings.data == Some(StepData::Array);
    declared(block).any(|variable| {
        let is = |name: &str| variable.name.eq_ignore_ascii_case(name);
        match ENGINE_NAMES.iter().find(|name| is(name)) {
            None => false,
            Some(&("G7S" | "G7T")) => arrays,
            Some(&TIA_DATA) => chart.dialect == Dialect::Tia,
            Some(_) => chart.dialect != Dialect::Tia,
        }
    })
}

/// The block with all declarations of its chart: operating parameters before those of the block, data of the chart after
/// its static data.
pub fn expanded(block: &ast::CodeBlock, chart: &Chart) -> ast::CodeBlock {
    let members = Members::new(block, chart);
    let mut expanded = block.clone();
    let declared: FxHashSet<String> = declared(block).map(|variable| fold(&variable.name)).collect();
    let interface = chart.settings.interface.unwrap_or(parameters::default_interface(chart.dialect));
    let mut front = Vec::new();
    for kind in [SectionKind::Input, SectionKind::Output] {
        let implied =
            parameters::implied(interface).filter(|one| one.section == kind && !declared.contains(&fold(one.name)));
        let text: String = implied.map(|one| format!("{} : {};\n", one.name, one.ty)).collect();
        front.push(section(kind, variables(&text), block.name.span()));
    }
    expanded.sections.splice(0..0, front);
    expanded.sections.push(section(SectionKind::Static, chart_data(chart, &members), block.name.span()));
    expanded
}

fn section(kind: SectionKind, variables: Vec<Variable>, span: Span) -> Section {
    Section { kind, retain: ast::Retain::Unsaid, variables, span }
}

fn chart_data(chart: &Chart, members: &Members) -> Vec<Variable> {
    if chart.steps.is_empty() {
        return Vec::new();
    }
    let mut data = Vec::new();
    let of_transitions: Vec<TypeKind> = chart.transitions.iter().map(|one| transition_type(one.number)).collect();
    let of_steps: Vec<TypeKind> = chart.steps.iter().map(|step| step_type(chart.dialect, step)).collect();
    if members.arrays {
        data.extend(array("G7T", of_transitions, "TNO", chart.transitions.iter().map(|one| one.number)));
        data.extend(array("G7S", of_steps, "SNO", chart.steps.iter().map(|one| one.number)));
    } else {
        data.extend(members.transitions.iter().zip(of_transitions).map(|(name, ty)| variable(name, ty)));
        data.extend(members.steps.iter().zip(of_steps).map(|(name, ty)| variable(name, ty)));
    }
    let engine = variables(&engine_data(chart));
    match chart.dialect {
        Dialect::Tia => data.push(variable(TIA_DATA, TypeKind::Struct(engine))),
        Dialect::Classic | Dialect::Sfc => data.extend(engine),
    }
    data
}

/// Data that the engine keeps from call to call.
fn engine_data(chart: &Chart) -> String {
    let settings = &chart.settings;
    let steps = chart.steps.len();
    let bits = |initial: &dyn Fn(&str) -> bool| -> String {
        let bit = |name: &&str| format!("{name} : BOOL{};", if initial(name) { " := TRUE" } else { "" });
        OPERATING_BITS.iter().map(bit).collect()
    };
    let start = |name: &str| start_value(settings, name);
    let never = |_: &str| false;
    // Choices at the start come from no edge: an operator's choice in the first call has priority.
    let chosen = |name: &str| matches!(name, "AUTO" | "SACT_DISP");
    let list = format!("ARRAY[0..{last}] OF BYTE := [BYTE#1, {last}(BYTE#0)]", last = steps + 1);
    format!(
        "SAX : {list}; S0X : {list}; S1X : {list};
        MOPEDGE : STRUCT {none} END_STRUCT; MOP : STRUCT {all} END_STRUCT;
        SQ_FLAGS : STRUCT ERR_FLT, ERROR, FAULT, SQ_ISOFF : BOOL; END_STRUCT;
        G7_DATA : STRUCT OLD : STRUCT {old} END_STRUCT;
            STARTED, REQUESTED, PAGED, ALL_WERE, EVENTFUL : BOOL; LAST : DINT; SHOWN, SHOWN_AT, SEL_OLD, T_SHOWN : INT;
            ASKED_ON, ASKED_OFF : ARRAY[1..{steps}] OF BOOL; ACTIVE : ARRAY[1..{active}] OF BYTE;
        END_STRUCT;",
        none = bits(&never),
        old = bits(&chosen),
        all = bits(&start),
        active = 8 * words(steps),
    )
}

/// Whether a bit of MOP is 1 in a new instance.
fn start_value(settings: &Settings, name: &str) -> bool {
    match name {
        "ACKREQ" => settings.acknowledge.unwrap_or(true),
        "SSKIP" => settings.skip_steps.unwrap_or(false),
        "ILP_MAN" => settings.manual_interlocks.unwrap_or(false),
        _ => START_VALUES.contains(&name),
    }
}

/// MOP as a double word as long as nobody changes the modes: its start values without the request among them.
pub fn usual_modes(settings: &Settings) -> u32 {
    let bits = OPERATING_BITS.iter().enumerate().filter(|(_, name)| **name != "INIT" && start_value(settings, name));
    bits.fold(0, |modes, (at, _)| modes | 1 << (8 * (3 - at / 8) + at % 8))
}

/// Words of 64 bits that hold a set of steps.
fn words(steps: usize) -> usize {
    steps.div_ceil(64).max(1)
}

fn step_type(dialect: Dialect, step: &plcc_syntax::chart::ast::Step) -> TypeKind {
    let text = match dialect {
        Dialect::Classic | Dialect::Sfc => STEP,
        Dialect::Tia => TIA_STEP,
    };
    let mut members = variables(text);
    for member in &mut members {
        let value = match member.name.as_str() {
            "SNO" => Some(number(step.number)),
            "T_MAX" => step.maximum.clone(),
            "T_WARN" => step.warning.clone(),
            _ => None,
        };
        member.initial = value.map(initial).or(member.initial.take());
    }
    TypeKind::Struct(members)
}

/// Whether data of this type are those of a step or transition.
pub fn is_step_or_transition(ty: &DataType) -> bool {
    let DataType::Struct(structure) = ty else { return false };
    structure.members.iter().any(|member| matches!(member.name.as_str(), "SNO" | "TNO"))
}

/// The type that a name of the TIA Portal means: `G7_StepPlus_V6`, `G7_TransitionPlus_V4`; `G7_RTDataPlus_V5` with the parts that a program can name.
pub fn type_named(name: &str) -> Option<TypeKind> {
    let folded = fold(name);
    let rest = folded.strip_prefix("g7_")?;
    let (stem, version) = rest.rsplit_once("_v").unwrap_or((rest, ""));
    if !version.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let members = match stem {
        "stepplus" => variables(TIA_STEP),
        "transitionplus" => variables(TRANSITION),
        "rtdataplus" => {
            let bits: String = OPERATING_BITS.iter().map(|name| format!("{name} : BOOL;")).collect();
            variables(&format!("MOP : STRUCT {bits} END_STRUCT;"))
        }
        _ => return None,
    };
    Some(TypeKind::Struct(members))
}

fn transition_type(user_number: u32) -> TypeKind {
    let mut members = variables(TRANSITION);
    for member in members.iter_mut().filter(|member| member.name == "TNO") {
        member.initial = Some(initial(number(user_number)));
    }
    TypeKind::Struct(members)
}

/// `G7S : ARRAY[1..n] OF STRUCT …`, each element with its number.
fn array(name: &str, types: Vec<TypeKind>, component: &str, numbers: impl Iterator<Item = u32>) -> Option<Variable> {
    let count = types.len() as i64;
    let element = TypeRef { kind: types.into_iter().next()?, span: nowhere() };
    let bounds = vec![(ast::Bound::Number(1, nowhere()), ast::Bound::Number(count, nowhere()))];
    let mut array = variable(name, TypeKind::Array { bounds, element: Box::new(element) });
    let field = scl::ast::Name { text: component.to_string(), form: scl::ast::NameForm::Bare, span: nowhere() };
    let values = numbers.map(|user_number| InitialValue {
        kind: InitialKind::Fields(vec![(Some(field.clone()), initial(number(user_number)))]),
        span: nowhere(),
    });
    array.initial = Some(InitialValue { kind: InitialKind::List(values.collect()), span: nowhere() });
    Some(array)
}

fn variable(name: &str, kind: TypeKind) -> Variable {
    Variable::new(name, TypeRef { kind, span: nowhere() }, nowhere())
}

/// Numbers beyond INT are reported by the analysis.
fn number(value: u32) -> Expr {
    let value = u64::from(value.min(i16::MAX as u32));
    Expr { kind: ExprKind::Literal(Literal::Integer { value, based: false }), span: nowhere() }
}

fn initial(value: Expr) -> InitialValue {
    InitialValue { span: value.span, kind: InitialKind::Expr(Box::new(value)) }
}

fn nowhere() -> Span {
    Span::new(SYSTEM_FILE, 0..0)
}

/// Declarations in SCL.
fn variables(text: &str) -> Vec<Variable> {
    let source = format!("FUNCTION_BLOCK \"x\"\nVAR\n{text}\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n");
    let (unit, messages) = scl::parse(SYSTEM_FILE, &source, &ParseOptions::default());
    debug_assert!(messages.is_empty(), "{messages:?}\n{source}");
    let blocks = unit.blocks.into_iter().filter_map(|block| match block {
        ast::Block::Code(code) => Some(code),
        ast::Block::Data(_) | ast::Block::Type(_) => None,
    });
    blocks.flat_map(|code| code.sections).flat_map(|section| section.variables).collect()
}
