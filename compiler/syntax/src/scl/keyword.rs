//! Reserved words of SCL, and the words that are reserved only in headers.

macro_rules! keywords {
    ($( $variant:ident $word:literal ),* $(,)?) => {
        /// A reserved word.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Keyword { $( $variant ),* }

        impl Keyword {
            /// In the order of their words.
            pub const ALL: &[Keyword] = &[$( Keyword::$variant ),*];

            /// The keyword that `upper`, in upper case, is.
            pub(super) fn lookup(upper: &[u8]) -> Option<Keyword> {
                $( const $variant: &[u8] = $word.as_bytes(); )*
                #[allow(non_upper_case_globals)]
                match upper {
                    $( $variant => Some(Keyword::$variant), )*
                    _ => None,
                }
            }

            pub const fn word(self) -> &'static str {
                match self { $( Keyword::$variant => $word ),* }
            }
        }
    };
}

/// Whether `upper`, in upper case, begins or ends a statement or a part of one; for sources that are not SCL.
pub fn is_statement_word(upper: &str) -> bool {
    let keyword = Keyword::lookup(upper.as_bytes());
    keyword.is_some_and(|word| word.begins_statement() || word.closes_statement())
        || matches!(upper, "REGION" | "END_REGION")
}

#[allow(non_upper_case_globals)]
mod table {
    keywords! {
        And "AND",
        Array "ARRAY",
        At "AT",
        Begin "BEGIN",
        By "BY",
        Case "CASE",
        Const "CONST",
        Continue "CONTINUE",
        DataBlock "DATA_BLOCK",
        Div "DIV",
        Do "DO",
        Else "ELSE",
        ElseIf "ELSEIF",
        Elsif "ELSIF",
        EndCase "END_CASE",
        EndConst "END_CONST",
        EndDataBlock "END_DATA_BLOCK",
        EndFor "END_FOR",
        EndFunction "END_FUNCTION",
        EndFunctionBlock "END_FUNCTION_BLOCK",
        EndIf "END_IF",
        EndLabel "END_LABEL",
        EndOrganizationBlock "END_ORGANIZATION_BLOCK",
        EndProgram "END_PROGRAM",
        EndRepeat "END_REPEAT",
        EndStruct "END_STRUCT",
        EndType "END_TYPE",
        EndVar "END_VAR",
        EndWhile "END_WHILE",
        Exit "EXIT",
        False "FALSE",
        For "FOR",
        Function "FUNCTION",
        FunctionBlock "FUNCTION_BLOCK",
        Goto "GOTO",
        If "IF",
        Label "LABEL",
        Mod "MOD",
        Nil "NIL",
        Not "NOT",
        Null "NULL",
        Of "OF",
        Or "OR",
        OrganizationBlock "ORGANIZATION_BLOCK",
        Program "PROGRAM",
        Ref "REF",
        RefTo "REF_TO",
        Repeat "REPEAT",
        Return "RETURN",
        String "STRING",
        Struct "STRUCT",
        Then "THEN",
        To "TO",
        True "TRUE",
        Type "TYPE",
        Until "UNTIL",
        Var "VAR",
        VarInOut "VAR_IN_OUT",
        VarInput "VAR_INPUT",
        VarOutput "VAR_OUTPUT",
        VarTemp "VAR_TEMP",
        While "WHILE",
        Wstring "WSTRING",
        Xor "XOR",
    }
}

pub use table::Keyword;

/// Length of the longest keyword.
const LONGEST: usize = 22;

impl Keyword {
    /// The keyword that `word` is, in any letter case.
    pub fn from_word(word: &str) -> Option<Keyword> {
        let mut buffer = [0u8; LONGEST];
        let upper = buffer.get_mut(..word.len())?;
        upper.copy_from_slice(word.as_bytes());
        upper.make_ascii_uppercase();
        Keyword::lookup(upper)
    }

    /// A word of structured text as IEC 61131-3 has it; the others are names there.
    pub const fn is_iec(self) -> bool {
        !matches!(
            self,
            Keyword::Begin
                | Keyword::Const
                | Keyword::DataBlock
                | Keyword::Div
                | Keyword::ElseIf
                | Keyword::EndConst
                | Keyword::EndDataBlock
                | Keyword::EndLabel
                | Keyword::EndOrganizationBlock
                | Keyword::Goto
                | Keyword::Label
                | Keyword::Nil
                | Keyword::Null
                | Keyword::OrganizationBlock
                | Keyword::Ref
        )
    }

    /// The word that ends a block.
    pub const fn ends_block(self) -> bool {
        matches!(
            self,
            Keyword::EndOrganizationBlock
                | Keyword::EndFunction
                | Keyword::EndFunctionBlock
                | Keyword::EndProgram
                | Keyword::EndDataBlock
                | Keyword::EndType
        )
    }

    /// The word that begins a block; `TYPE` and `PROGRAM` only before a name.
    pub const fn begins_block(self) -> bool {
        matches!(
            self,
            Keyword::OrganizationBlock
                | Keyword::Function
                | Keyword::FunctionBlock
                | Keyword::Program
                | Keyword::DataBlock
                | Keyword::Type
        )
    }

    /// The word that begins declarations.
    pub const fn begins_section(self) -> bool {
        matches!(
            self,
            Keyword::Var
                | Keyword::VarInput
                | Keyword::VarOutput
                | Keyword::VarInOut
                | Keyword::VarTemp
                | Keyword::Const
                | Keyword::Label
        )
    }

    /// The word that ends declarations.
    pub const fn ends_section(self) -> bool {
        matches!(self, Keyword::EndVar | Keyword::EndConst | Keyword::EndLabel)
    }

    /// The word that begins a statement.
    pub const fn begins_statement(self) -> bool {
        matches!(
            self,
            Keyword::If
                | Keyword::Case
                | Keyword::For
                | Keyword::While
                | Keyword::Repeat
                | Keyword::Exit
                | Keyword::Continue
                | Keyword::Return
                | Keyword::Goto
        )
    }

    /// The word that ends a structured statement or a part of it.
    pub const fn closes_statement(self) -> bool {
        matches!(
            self,
            Keyword::EndIf
                | Keyword::EndCase
                | Keyword::EndFor
                | Keyword::EndWhile
                | Keyword::EndRepeat
                | Keyword::Else
                | Keyword::ElseIf
                | Keyword::Elsif
                | Keyword::Until
        )
    }

    /// The word that no expression contains.
    pub const fn ends_expression(self) -> bool {
        self.ends_block()
            || self.ends_section()
            || self.begins_section()
            || self.begins_statement()
            || self.closes_statement()
            || matches!(
                self,
                Keyword::Begin
                    | Keyword::Then
                    | Keyword::EndStruct
                    | Keyword::OrganizationBlock
                    | Keyword::Function
                    | Keyword::FunctionBlock
                    | Keyword::DataBlock
            )
    }

    /// The word of a statement or an expression; not the other spelling of ELSIF.
    pub const fn is_in_statements(self) -> bool {
        !matches!(self, Keyword::ElseIf)
            && (self.begins_statement()
                || self.closes_statement()
                || self.is_operator()
                || matches!(
                    self,
                    Keyword::Then
                        | Keyword::Of
                        | Keyword::To
                        | Keyword::By
                        | Keyword::Do
                        | Keyword::True
                        | Keyword::False
                ))
    }

    /// The word that comes between operands or before one.
    pub const fn is_operator(self) -> bool {
        matches!(self, Keyword::And | Keyword::Or | Keyword::Xor | Keyword::Not | Keyword::Mod | Keyword::Div)
    }
}
