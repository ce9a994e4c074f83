//! Uses in declarations: types, bounds, start values and constants.

use plcc_diag::Span;
use plcc_syntax::ast::{self, BlockName, BlockPrefix, Bound, OperandKind, PathRoot, TypeKind, TypeRef};
use plcc_syntax::scl::absolute;
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, NameForm};
use plcc_syntax::symbols::SymbolTarget;

use super::evidence::Hint;
use super::look::{Look, Step, of_constant, step_of_part};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;

impl Look<'_, '_> {
    /// Examines all types of declarations, used or not.
    pub fn declarations(&mut self, block: &ast::Block) {
        match block {
            ast::Block::Code(code) => {
                for variable in code.sections.iter().flat_map(|section| &section.variables) {
                    self.declared(variable);
                }
                if let Some(ty) = &code.return_type {
                    self.declared_as(ty);
                }
                for constant in &code.constants {
                    if let Some(ty) = &constant.ty {
                        self.declared_as(ty);
                    }
                    if let (Some(ty), Some(initial)) = (&constant.ty, &constant.initial) {
                        self.initial_names(initial);
                        self.initial_fields(ty, &mut Vec::new(), initial);
                    }
                    constant.value.iter().for_each(|value| self.constant_names(value, None));
                }
            }
            ast::Block::Data(data) => match &data.content {
                ast::DataContent::Struct(variables) => {
                    variables.iter().for_each(|variable| self.declared(variable));
                    let ty = TypeRef { kind: TypeKind::Struct(variables.clone()), span: data.span };
                    data.values.iter().for_each(|value| self.start_value(&ty, value));
                }
                ast::DataContent::OfType(ty) => {
                    self.declared_as(ty);
                    data.values.iter().for_each(|value| self.start_value(ty, value));
                }
                ast::DataContent::Array(ty, _) => self.declared_as(ty),
                ast::DataContent::Empty => {}
            },
            ast::Block::Type(ty) => {
                ty.members.iter().for_each(|variable| self.declared(variable));
                if let Some(alias) = &ty.alias {
                    self.declared_as(alias);
                }
            }
        }
    }

    /// Missing data blocks whose function block or data type a symbol table states: `"Drive_1","DB 12","FB 12",""`.
    pub fn rows_of_tables(&mut self) {
        let input = self.program.globals.input;
        for symbol in input.tables.iter().flat_map(|table| &table.symbols) {
            let word: String = symbol.ty.split_whitespace().collect();
            let (
                SymbolTarget::Block { prefix: BlockPrefix::Db, number: db },
                Some(OperandKind::Block(BlockName::Numbered { prefix, number, .. })),
            ) = (symbol.target, absolute(&word))
            else {
                continue;
            };
            let (Some(db), Some(of)) = (Missing::block(BlockPrefix::Db, db), Missing::block(prefix, number)) else {
                continue;
            };
            let is_there = match prefix {
                // Of a missing data type only the components that its variables use are known.
                BlockPrefix::Udt => self.is_block(prefix, number) && !self.found.things.contains_key(&of),
                BlockPrefix::Fb | BlockPrefix::Sfb => self.is_block(prefix, number),
                _ => false,
            };
            if let Some(shape) = self.found.things.get_mut(&db).filter(|_| is_there) {
                shape.of.get_or_insert(of);
            }
        }
    }

    fn declared(&mut self, variable: &ast::Variable) {
        self.declared_as(&variable.ty);
        if let Some(initial) = &variable.initial {
            self.initial_names(initial);
            self.initial_fields(&variable.ty, &mut Vec::new(), initial);
        }
    }

    /// Start values of components whose type is missing.
    fn initial_fields(&mut self, ty: &TypeRef, steps: &mut Vec<Step>, initial: &ast::InitialValue) {
        match &initial.kind {
            ast::InitialKind::Fields(fields) => {
                for (name, value) in fields {
                    let Some(name) = name else { continue };
                    steps.push(Step::Member(name.text.clone()));
                    self.initial_fields(ty, steps, value);
                    steps.pop();
                }
            }
            // Elements of an array have one type.
            ast::InitialKind::List(values) | ast::InitialKind::Repeat { values, .. } => {
                values.iter().for_each(|value| self.initial_fields(ty, steps, value));
            }
            ast::InitialKind::Elements(elements) => {
                for (indices, value) in elements {
                    steps.push(Step::Index(indices.iter().copied().map(Some).collect()));
                    self.initial_fields(ty, steps, value);
                    steps.pop();
                }
            }
            ast::InitialKind::Literal(_) | ast::InitialKind::Expr(_) | ast::InitialKind::Operand(_) => {
                let hint = self.initial_hint(initial);
                if !steps.is_empty() {
                    self.inside_type(ty, steps, initial.span, &mut |shape| shape.learn(hint.as_ref()), 0);
                }
            }
            ast::InitialKind::Default => {}
        }
    }

    /// The type of a start value.
    fn initial_hint(&mut self, initial: &ast::InitialValue) -> Option<Hint> {
        match &initial.kind {
            ast::InitialKind::Literal(literal) => Constant::of_stl(literal).map(|constant| of_constant(&constant)),
            ast::InitialKind::Expr(node) => {
                let none = plcc_binding::constant::Constants::default();
                self.quietly(|program| program.globals.constant(&none, node)).map(|constant| of_constant(&constant))
            }
            _ => None,
        }
    }

    fn initial_names(&mut self, initial: &ast::InitialValue) {
        match &initial.kind {
            ast::InitialKind::Expr(value) => self.constant_names(value, None),
            ast::InitialKind::List(values) => values.iter().for_each(|value| self.initial_names(value)),
            ast::InitialKind::Repeat { count, values } => {
                self.bound_names(count);
                values.iter().for_each(|value| self.initial_names(value));
            }
            ast::InitialKind::Elements(elements) => elements.iter().for_each(|(_, value)| self.initial_names(value)),
            ast::InitialKind::Fields(fields) => fields.iter().for_each(|(_, value)| self.initial_names(value)),
            ast::InitialKind::Literal(_) | ast::InitialKind::Operand(_) | ast::InitialKind::Default => {}
        }
    }

    fn bound_names(&mut self, bound: &Bound) {
        match bound {
            Bound::Number(..) => {}
            Bound::Name(name, span) => self.missing_constant(name, *span, None),
            Bound::Expr(value) => self.constant_names(value, None),
            // Only indices in code of STL are paths.
            Bound::Path(_) => {}
        }
    }

    /// A missing constant that is the lower bound of an array is below all others.
    fn lower_bound(&mut self, bound: &Bound) {
        if let Bound::Name(name, _) = bound
            && let Some(shape) = self.found.things.get_mut(&Missing::name(name))
        {
            shape.is_lower = true;
        }
    }

    /// Types that a declaration names.
    fn declared_as(&mut self, ty: &TypeRef) {
        match &ty.kind {
            TypeKind::Array { bounds, element } => {
                for (low, high) in bounds {
                    self.bound_names(low);
                    self.bound_names(high);
                    self.lower_bound(low);
                }
                self.declared_as(element);
            }
            TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => self.declared_as(element),
            TypeKind::Struct(variables) => variables.iter().for_each(|variable| self.declared(variable)),
            TypeKind::String(Some(bound)) | TypeKind::WideString(Some(bound)) => self.bound_names(bound),
            TypeKind::String(None) | TypeKind::WideString(None) | TypeKind::Error => {}
            TypeKind::Named(_) | TypeKind::Block(_) => self.inside_type(ty, &[], ty.span, &mut |_| {}, 0),
        }
    }

    /// A start value of a data block whose type is missing.
    fn start_value(&mut self, ty: &TypeRef, value: &ast::ValueAssignment) {
        let (PathRoot::Local { name, .. } | PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. }) =
            &value.target.root
        else {
            return;
        };
        let mut steps = vec![Step::Member(name.clone())];
        steps.extend(value.target.parts.iter().map(step_of_part));
        self.initial_fields(ty, &mut steps, &value.value);
    }

    /// Names in an expression that must be constant.
    pub fn constant_names(&mut self, node: &Node, hint: Option<&Hint>) {
        match &node.kind {
            NodeKind::Name(name) if name.form != NameForm::Local => self.missing_constant(&name.text, name.span, hint),
            NodeKind::Unary { operand, .. } => self.constant_names(operand, hint),
            NodeKind::Binary { left, right, .. } => {
                self.constant_names(left, hint);
                self.constant_names(right, hint);
            }
            NodeKind::Call { arguments, .. } => {
                for value in arguments.iter().filter_map(|argument| argument.value.as_ref()) {
                    self.constant_names(value, None);
                }
            }
            _ => {}
        }
    }

    fn missing_constant(&mut self, name: &str, span: Span, hint: Option<&Hint>) {
        let folded = fold(name);
        // Constants of blocks are looked up in their own lists first.
        let own = self.program.types.scope.constants.contains_key(&folded)
            || self.program.globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks).any(|block| match block {
                ast::Block::Code(code) if code.span.file == span.file => {
                    code.constants.iter().any(|constant| fold(&constant.name) == folded)
                }
                _ => false,
            });
        let missing = Missing::name(name);
        let known = own
            || self.program.globals.names.constants.contains_key(&folded)
            || self.program.globals.global(name).is_some()
            || absolute(name).is_some();
        if !known || self.found.things.contains_key(&missing) {
            let shape = self.found.of(missing, name, span);
            shape.is_constant = true;
            shape.learn(hint);
        }
    }
}
