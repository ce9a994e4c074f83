//! Binding of GRAPH: a chart becomes statements of the typed tree of SCL, so that all languages share one lowering.
//!
//! - `index`: steps and transitions by name and number; `names`: their names in expressions.
//! - `engine.scl`, `alone.scl`, `finish.scl`, `monitor.scl`: one call of the block as SCL with placeholders; `template` reads them.
//! - `engine_data`: the data that statements of the chart use: where it is, sets of steps; `build`: pieces of the typed tree.
//! - `action`: rows of actions; `permanent`: permanent instructions; `condition`: conditions; `call`: block calls of the first two;
//!   `leaving`: statements that are not possible in them.
//! - `assemble`: the code of steps and transitions, put into the placeholders.
//! - `alone`: the short way of a call with one active step; `quick`: a quicker one for charts that have less; `ordinary`: their actions.
//! - `rivals`: which steps use what the code of others writes.
//! - `analysis`: which charts are valid.
//!
//! Source: GRAPH reference, chapters D to G.

mod action;
mod alone;
mod analysis;
mod assemble;
mod build;
mod call;
mod condition;
mod engine_data;
mod index;
mod leaving;
mod names;
mod ordinary;
mod permanent;
mod quick;
mod rivals;
mod template;
#[cfg(test)]
mod testing;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, SectionKind};
use plcc_syntax::chart::ast::{Body as Chart, Condition as Tree, Dialect, Qualifier};
use plcc_syntax::chart::parameters::{self, Effect, PARAMETERS, Parameter};
use plcc_syntax::scl;

use super::scl::Scope;
use super::scl::temporary;
use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::{SclBinder, SclBlock, marks_locals};
use crate::bind::trees::chart_data::{self, Members};
use assemble::{Assembly, Condition, Features, Parts};
use build::number;
use engine_data::Engine;
use index::Index;
use plcc_model::Direction;
use plcc_model::scl::{SclBody, Statement, StatementKind, walk};
use plcc_model::types::DataType;
use template::{ALONE, ENGINE, FINISH, MONITOR, Meaning, QUICK};

/// Clears the requests of ON, OFF and the operator.
const CLEAR_REQUESTS: &str = "#REQUESTED := FALSE;
FOR #j := 1 TO #steps DO
  #ASKED_ON[#j] := FALSE;
  #ASKED_OFF[#j] := FALSE;
END_FOR;";

/// The transition that the code of step `k` has selected leaves it and enters the step at `target`.
const SWITCH_OVER: &str = "IF #target > 0 THEN
  #left := #left + 1;
  #S0X[#left] := DINT_TO_BYTE(#k);
  mark_left();
  #k := #target;
  #target := 0;
  is_entered();
  IF NOT #known THEN
    #entered := #entered + 1;
    #S1X[#entered] := DINT_TO_BYTE(#k);
    mark_entered();
  END_IF;
END_IF;";

/// Time of step `k`, and the end of its events. T and U are added to at the same time, unless one of them is at its end, or U stands still
/// with LA and VA.
const TICK: &str = "IF #RAW[#k].EVENTS <> BYTE#0 THEN
  expire();
  #RAW[#k].EVENTS := 0;
END_IF;
add_pair();
IF #known THEN
  put_pair();
ELSE
  add_one_by_one();
END_IF;";

/// The same without numbers of 64 bits.
const PLAIN_TICK: &str = "IF #RAW[#k].EVENTS <> BYTE#0 THEN
  expire();
  #RAW[#k].EVENTS := 0;
END_IF;
add_one_by_one();";

/// T and U of step `k`, one after the other.
const ADD_ONE_BY_ONE: &str = "#elapsed := #RAW[#k].T + #passed;
IF #elapsed < 0 THEN
  #elapsed := 2147483647;
END_IF;
#RAW[#k].T := #elapsed;
IF (#RAW[#k].STATES AND BYTE#16#06) = BYTE#0 THEN
  #elapsed := #RAW[#k].U + #passed;
  IF #elapsed < 0 THEN
    #elapsed := 2147483647;
  END_IF;
  #RAW[#k].U := #elapsed;
END_IF;";

/// What the outputs of the block need to know of step `k`.
const NOTE: &str = "IF has_monitoring THEN
  #error := #error OR #G7S[#k].LA;
  #fault := #fault OR #G7S[#k].VA;
END_IF;
IF has_display THEN
  IF #lowest = 0 OR #RAW[#k].SNO < #lowest THEN
    #lowest := #RAW[#k].SNO;
    #lowest_at := DINT_TO_INT(#k);
  END_IF;
  IF has_monitoring THEN
    IF (#G7S[#k].LA OR #G7S[#k].VA) AND (#lowest_faulty = 0 OR #RAW[#k].SNO < #lowest_faulty) THEN
      #lowest_faulty := #RAW[#k].SNO;
      #lowest_faulty_at := DINT_TO_INT(#k);
    END_IF;
    IF #G7S[#k].LA OR #G7S[#k].VA THEN
      #faults := #faults + 1;
    END_IF;
  END_IF;
END_IF;";

/// Phases 1 to 3 of the short way, without its steps.
const BEGIN: &str = "IF has_display THEN
  #SEL_OLD := #S_SEL;
END_IF;
before();
#now := TIME_TO_DINT(TIME_TCK());
#passed := DWORD_TO_DINT(DINT_TO_DWORD(#now - #LAST) AND DWORD#16#7FFFFFFF);
make_pair_since();
#LAST := #now;";

/// Ends the events of step `k`, which the last call left.
const END_STEP: &str = "IF #RAW[#k].EVENTS <> BYTE#0 THEN
  expire();
  #RAW[#k].EVENTS := 0;
END_IF;
forget();";

/// The same for all of them.
const END_OF_LEAVING: &str = "IF #S0X[0] > BYTE#1 THEN
  FOR #i := 1 TO BYTE_TO_DINT(#S0X[0]) - 1 DO
    #k := BYTE_TO_DINT(#S0X[#i]);
    only_steps();
    end_step();
  END_FOR;
  #S0X[0] := BYTE#1;
END_IF;";

/// What SQ_FLAGS says.
const FLAGS: &str = "#SQ_FLAGS.ERROR := #error;
#SQ_FLAGS.FAULT := #fault;
#SQ_FLAGS.ERR_FLT := #error OR #fault;
#SQ_FLAGS.SQ_ISOFF := #count = 0;";

/// The same, all in one byte, on the quick way.
const QUICK_FLAGS: &str = "#SQ_BYTE := BYTE#0;
IF #empty THEN
  #SQ_BYTE := BYTE#16#08;
END_IF;";

/// Continues a loop if `k` is not a position of a step.
const ONLY_STEPS: &str = "IF DINT_TO_UDINT(#k - 1) <= #last_step THEN ; ELSE CONTINUE; END_IF;";

/// The same without types that the S7-300 does not have.
const PLAIN_ONLY_STEPS: &str = "IF #k < 1 OR #k > #steps THEN CONTINUE; END_IF;";

/// Binds charts of GRAPH.
pub struct ChartBinder<'b, 'a> {
    program: &'b mut Declarations<'a>,
}

impl<'b, 'a> ChartBinder<'b, 'a> {
    pub fn new(program: &'b mut Declarations<'a>) -> ChartBinder<'b, 'a> {
        ChartBinder { program }
    }

    /// SCL, for expressions and statements of conditions and actions.
    fn scl(&mut self) -> SclBinder<'_, 'a> {
        SclBinder::new(self.program)
    }

    /// LAD and FBD, for conditions and actions that are networks.
    fn networks(&mut self) -> NetworkBinder<'_, 'a> {
        NetworkBinder::new(self.program)
    }
}

impl ChartBinder<'_, '_> {
    /// Binds the chart of a block.
    pub fn bind_block(&mut self, current: &mut CurrentBlock, block: &ast::CodeBlock, chart: &Chart) -> SclBody {
        let dialect = match chart.dialect {
            Dialect::Classic => scl::ast::Dialect::Classic,
            Dialect::Tia | Dialect::Sfc => scl::ast::Dialect::Tia,
        };
        let scope = Scope::new(self.program.globals.input, &block.header, dialect);
        let ctx = &mut SclBlock { block: current, scope };
        ctx.scope.address_numbers = chart.dialect == Dialect::Classic;
        ctx.scope.marks_locals = marks_locals(&block.code);
        let sets_flag = ctx.scope.sets_flag;
        let index = Index::new(chart);
        self.check_chart(ctx, block, chart, &index);
        let members = Members::new(block, chart);
        let chart = &self.resolved_chart(block, chart, &index, &members);
        let span = block.name.span();
        if chart_data::clashes(block, chart) {
            return SclBody::default();
        }
        let is_plain = self.program.globals.input.plain_charts;
        let Some(mut engine) = Engine::new(ctx, chart, &index, &members, (span, is_plain)) else {
            return SclBody::default();
        };
        let parts = self.chart_parts(ctx, &mut engine);
        self.scl().unused_data(ctx, block, false);
        let mut statements = self.fill_engine(ctx, &mut engine, parts);
        let yes = number(1, Elementary::Bool, span);
        statements.push(Statement { kind: StatementKind::SetFlag(yes), span });
        SclBody {
            statements,
            sets_flag,
            calls_set_flag: false,
            temporary_texts: temporary::texts(&ctx.block.bound),
            networks: Vec::new(),
            inputs_in_place: false,
            named_dbs: std::mem::take(&mut ctx.scope.named_dbs),
        }
    }

    /// Binds conditions, actions and permanent instructions.
    fn chart_parts(&mut self, ctx: &mut SclBlock, engine: &mut Engine) -> Parts {
        let chart = engine.chart;
        let index = engine.index;
        let places = |names: &[scl::ast::Name]| -> Vec<usize> {
            let mut places: Vec<usize> = Vec::new();
            for place in names.iter().filter_map(|name| index.step(&name.text)) {
                if !places.contains(&place) {
                    places.push(place);
                }
            }
            places
        };
        let before = self.permanent_code(ctx, engine, &chart.before);
        let mut interlocks = Vec::new();
        let mut supervisions = Vec::new();
        let mut codes = Vec::new();
        for (at, step) in chart.steps.iter().enumerate() {
            let name = &step.name.text;
            interlocks.push(self.chart_condition(
                ctx,
                engine,
                step.interlock.as_ref(),
                &format!("the interlock of `{name}`"),
            ));
            let what = format!("the supervision of `{name}`");
            supervisions.push(self.chart_condition(ctx, engine, step.supervision.as_ref(), &what));
            codes.push(self.step_code(ctx, engine, at));
        }
        let mut conditions = Vec::new();
        for transition in &chart.transitions {
            let what = format!("the transition `{}`", transition.name.text);
            let condition = self.chart_condition(ctx, engine, transition.condition.as_ref(), &what);
            conditions.push(condition.unwrap_or_else(|| (Vec::new(), number(1, Elementary::Bool, transition.span))));
        }
        let after = self.permanent_code(ctx, engine, &chart.after);
        let from = chart.transitions.iter().map(|one| places(&one.from)).collect();
        let to = chart.transitions.iter().map(|one| places(&one.to)).collect();
        Parts { before, after, codes, interlocks, supervisions, conditions, from, to }
    }

    /// A condition, if there is one; FALSE if it could not be bound.
    fn chart_condition(
        &mut self,
        ctx: &mut SclBlock,
        engine: &mut Engine,
        condition: Option<&Tree>,
        what: &str,
    ) -> Option<Condition> {
        let condition = condition?;
        let (statements, value) = self
            .condition_code(ctx, engine, condition, what)
            .unwrap_or_else(|| (Vec::new(), number(0, Elementary::Bool, engine.span)));
        if let Some(span) = label(&statements) {
            self.program.report(
                Diagnostic::new(Code::ElementPlace, span, format!("{what} has a jump label"))
                    .label("conditions are evaluated without jumps")
                    .help("write the condition with AND, OR and comparisons, or compute it in a permanent instruction"),
            );
            return Some((Vec::new(), value));
        }
        Some((statements, value))
    }

    /// Puts the code of the chart into the engine.
    fn fill_engine(&mut self, ctx: &mut SclBlock, engine: &mut Engine, parts: Parts) -> Vec<Statement> {
        let chart = engine.chart;
        let owned = assemble::owners(chart.steps.len(), &parts.from, &chart.transitions);
        let competing = assemble::competing(chart.steps.len(), &parts.from, &chart.transitions);
        let most = owned.iter().map(Vec::len).max().unwrap_or(0);
        let results = (0..most).map(|_| engine.page.pool.lasting(ctx, Elementary::Bool).variable()).collect();
        let declared = |name: &str| parameters::find(name).is_some_and(|parameter| is_declared(ctx, parameter));
        let any = |names: &[&str]| names.iter().any(|name| declared(name));
        let supervision = parts.supervisions.iter().any(Option::is_some);
        let transition_display = any(&["T_NO", "T_MORE", "T_PREV", "T_NEXT"]);
        let skips = chart.settings.skip_steps == Some(true) || declared("EN_SSKIP") || self.mentions_word("SSKIP");
        let blocks = &self.program.data.blocks;
        let is_shared = |number: u16| Some(blocks.get(&number)?.block.instance_of.is_none());
        let alone = !engine.is_plain && alone::is_possible(engine, &parts, &competing, &is_shared);
        let is_wide =
            parts.to.iter().any(|to| to.len() > 1) || chart.steps.iter().filter(|step| step.initial).count() > 1;
        let monitoring = supervision || parts.interlocks.iter().any(Option::is_some);
        // On the short way a step is monitored before it is left.
        let selection = supervision || !competing.is_empty() || transition_display || alone && monitoring;
        let requests = chart.steps.iter().flat_map(|step| &step.actions).any(|row| row.qualifier == Qualifier::Off);
        let displays = any(&DISPLAYS) || transition_display;
        let one_loop = alone && alone::is_independent(engine, &parts, &is_shared);
        let tame_actions = alone && alone::has_tame_actions(engine, &parts, &is_shared);
        let own_end = alone && alone::is_copyable(&parts.after) && !displays;
        let has_less = one_loop && tame_actions && own_end && !selection && !requests;
        let can_end = parts.to.iter().any(Vec::is_empty);
        let quick = has_less && quick::is_possible(engine, &parts, is_wide, &is_shared);
        let features = Features {
            monitoring,
            selection,
            all_conditions: self.mentions_word("T_PERM"),
            skipping: skips,
            display: any(&DISPLAYS),
            transition_display,
            safe_activation: chart.settings.safe_activation == Some(true),
            requests,
            alone,
            several: alone && is_wide && !selection,
            one_loop,
            tame_actions,
            own_end,
            quick,
        };
        let has_before = !parts.before.is_empty();
        let has_edges =
            |one: &&Parameter| matches!(one.effect, Effect::Set(_) | Effect::Toggle(_)) && declared(one.name);
        let only_init = PARAMETERS.iter().filter(has_edges).map(|one| one.name).eq(["INIT_SQ"]);
        let meaning = |name: &str| -> Meaning {
            match name {
                "has_monitoring" => Meaning::Bool(features.monitoring),
                "has_selection" => Meaning::Bool(features.selection),
                "has_all_conditions" => Meaning::Bool(features.all_conditions),
                "has_skipping" => Meaning::Bool(features.skipping),
                "has_display" => Meaning::Bool(features.display),
                "has_transition_display" => Meaning::Bool(features.transition_display),
                "has_several" => Meaning::Bool(features.several),
                "has_alone" => Meaning::Bool(features.alone),
                "has_one_loop" => Meaning::Bool(features.one_loop),
                "has_tame_actions" => Meaning::Bool(features.tame_actions),
                "has_own_end" => Meaning::Bool(features.own_end),
                "empty" if !can_end => Meaning::Bool(false),
                "has_quick" => Meaning::Bool(features.quick),
                "short" if !features.alone => Meaning::Bool(false),
                "done" if !features.alone || features.quick => Meaning::Bool(false),
                "ended" if !features.own_end || features.quick => Meaning::Bool(false),
                "has_before" => Meaning::Bool(has_before),
                "has_more_inputs" => Meaning::Bool(!only_init),
                "has_usual_modes" => Meaning::Bool(quick::has_usual_modes(&chart.settings)),
                "has_safe_activation" => Meaning::Bool(features.safe_activation),
                "has_several_steps" => Meaning::Bool(chart.steps.len() > 1),
                "steps" => Meaning::Number(chart.steps.len() as u64),
                "last_step" => Meaning::Number(chart.steps.len() as u64 - 1),
                "transitions" => Meaning::Number(chart.transitions.len() as u64),
                _ => match PARAMETERS.iter().find(|one| one.name == name && one.effect == Effect::Named) {
                    Some(parameter) if !is_declared(ctx, parameter) => match parameter.ty {
                        "BOOL" => Meaning::Bool(false),
                        _ => Meaning::Number(0),
                    },
                    _ => Meaning::Kept,
                },
            }
        };
        let quick_finish = FINISH.replace("flags();", QUICK_FLAGS).replace("#count = 0", "#empty");
        let text = ENGINE
            .replace("alone_way();", if quick { QUICK } else { ALONE })
            .replace("finish_quick();", &quick_finish)
            .replace("begin();", BEGIN)
            .replace("end_of_leaving();", END_OF_LEAVING)
            .replace("end_step();", END_STEP)
            .replace("finish();", FINISH)
            .replace("flags();", FLAGS)
            .replace("edges();", &parameters::edges(declared))
            .replace("monitor();", MONITOR)
            .replace("tick();", if engine.is_plain { PLAIN_TICK } else { TICK })
            .replace("add_one_by_one();", ADD_ONE_BY_ONE)
            .replace("note();", NOTE)
            .replace("only_steps();", if engine.is_plain { PLAIN_ONLY_STEPS } else { ONLY_STEPS })
            .replace("switch_over();", SWITCH_OVER)
            .replace("clear_requests();", CLEAR_REQUESTS);
        let trees = template::prune(template::parse(&text), &meaning);
        engine.restrict_sets(&features, &parts, &competing);
        let holes = Assembly::new(engine, parts, features, results, owned, competing).holes(&is_shared);
        self.bind_template(ctx, engine, &trees, holes)
    }

    /// Binds the engine's own statements, with its names and without the names of the user.
    fn bind_template(
        &mut self,
        ctx: &mut SclBlock,
        engine: &Engine,
        trees: &[scl::ast::Statement],
        holes: rustc_hash::FxHashMap<&'static str, Vec<Statement>>,
    ) -> Vec<Statement> {
        let mut scope = Scope::new(self.program.globals.input, &ast::Header::default(), scl::ast::Dialect::Tia);
        scope.holes = holes;
        scope.hidden = engine.names.iter().map(|(name, variable)| (name.to_string(), variable.clone())).collect();
        let users = std::mem::replace(&mut ctx.scope, scope);
        let span = ctx.block.fixed_span.replace(engine.span);
        let told = self.program.globals.report.diagnostics.len();
        let statements = self.scl().statements(ctx, trees);
        let messages = self.program.globals.report.diagnostics.split_off(told);
        debug_assert!(!messages.iter().any(Diagnostic::is_error), "{messages:?}");
        ctx.block.fixed_span = span;
        ctx.scope = users;
        statements
    }

    /// Whether a source has this word, in any letter case.
    fn mentions_word(&self, word: &str) -> bool {
        self.program.globals.input.sources.files().any(|(_, file)| {
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
            file.text.split(|c| !is_word(c)).any(|found| found.eq_ignore_ascii_case(word))
        })
    }
}

/// Parameters that depend on which step is shown.
const DISPLAYS: [&str; 12] = [
    "S_NO", "S_MORE", "S_ACTIVE", "S_TIME", "S_TIMEOK", "S_STATE", "S_SEL", "S_SELOK", "S_ON", "S_OFF", "ACK_S",
    "REG_S",
];

/// The block has this operating parameter: one with its name, type and direction.
fn is_declared(ctx: &SclBlock, parameter: &Parameter) -> bool {
    let direction = match parameter.section {
        SectionKind::Output => Direction::Output,
        _ => Direction::Input,
    };
    ctx.block.bound.interface.parameters.iter().any(|one| {
        one.name.eq_ignore_ascii_case(parameter.name)
            && one.direction == direction
            && one.ty == Elementary::from_word(parameter.ty).map_or(DataType::Void, DataType::Elementary)
    })
}

/// A jump label among statements.
fn label(statements: &[Statement]) -> Option<Span> {
    walk::find(statements, &|statement| matches!(statement.kind, StatementKind::Label(_)).then_some(statement.span))
}
