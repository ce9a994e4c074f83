//! The table of diagnostic codes. A code is never reused for another problem.
//!
//! `P01xx` reading and tokens, `P02xx` syntax, `P03xx` names and blocks, `P04xx` types and addresses, `P05xx` statements,
//! `P06xx` project and station, `P07xx` tests, `P08xx` S7-200, `P09xx` conversion. Each has a page in `pages/`, printed by `plcc explain`.

/// How serious a problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    Warning,
    Error,
}

macro_rules! codes {
    ($( $variant:ident = $code:literal $severity:ident $title:literal ; )*) => {
        /// A diagnostic code.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Code { $( #[doc = $title] $variant ),* }

        impl Code {
            /// All codes, in the order of the table.
            pub const ALL: &'static [Code] = &[ $(Code::$variant),* ];

            /// `P0203`.
            pub const fn name(self) -> &'static str {
                match self { $(Code::$variant => $code),* }
            }

            /// Short name of the problem, the heading of its page.
            pub const fn title(self) -> &'static str {
                match self { $(Code::$variant => $title),* }
            }

            /// Severity of its messages, unless a message overrides it.
            pub const fn severity(self) -> Severity {
                match self { $(Code::$variant => Severity::$severity),* }
            }

            /// The page that `plcc explain` prints, in Markdown.
            pub const fn page(self) -> &'static str {
                match self { $(Code::$variant => include_str!(concat!("../pages/", $code, ".md"))),* }
            }

            /// The code with this name; letter case does not matter.
            pub fn from_name(name: &str) -> Option<Code> {
                Code::ALL.iter().copied().find(|code| code.name().eq_ignore_ascii_case(name))
            }
        }
    };
}

codes! {
    UnexpectedCharacter = "P0101" Error "a character that no statement can contain";
    UnterminatedText = "P0102" Error "a text or symbol that is not closed on its line";
    BadLiteral = "P0103" Error "a constant that is not in the notation of STEP 7";
    LiteralRange = "P0104" Error "a constant outside the range of its type";
    BlockComment = "P0105" Warning "a comment in (* *), which STL does not have";
    BlanksInLiteral = "P0106" Warning "blanks inside a constant";
    TemplateMarker = "P0107" Error "a template marker that was never filled in";
    MixedMnemonics = "P0108" Error "mnemonics of both sets in one file";
    Syntax = "P0201" Error "a statement that breaks the syntax of its language";
    UnknownInstruction = "P0202" Error "an instruction that STL does not have";
    OperandKind = "P0203" Error "an operand that does not fit its instruction";
    MissingOperand = "P0204" Error "an instruction without its operand";
    SurplusOperand = "P0205" Error "an operand after an instruction that takes none";
    BlockFrame = "P0206" Error "a block that is not framed correctly";
    ForeignLanguage = "P0207" Error "statements of another language in a statement list";
    AssignSign = "P0208" Error "`=` where a parameter is assigned with `:=`";
    DeclarationSyntax = "P0209" Error "a declaration that breaks the syntax of STEP 7";
    NotASource = "P0210" Error "a file that contains no PLC source";
    Tolerated = "P0211" Warning "a form that the vendor rejects but that has only one meaning";
    MisspeltKeyword = "P0212" Error "a keyword that is misspelt";
    ForeignForm = "P0213" Error "a form of another programming language";
    UnknownSymbol = "P0301" Error "a symbol that neither a table nor a block defines";
    UnknownBlock = "P0302" Error "a block that is called but not defined";
    NotShipped = "P0303" Error "a system block that plcc does not have";
    DuplicateBlock = "P0304" Error "a block that is defined twice";
    DuplicateName = "P0305" Error "a name that is declared twice";
    UnknownLocal = "P0306" Error "a local name that the block does not declare";
    UnknownMember = "P0307" Error "a component that the structure does not have";
    UnknownLabel = "P0308" Error "a jump to a label that the block does not have";
    DuplicateLabel = "P0309" Error "a label that occurs twice in a block";
    SymbolTable = "P0310" Warning "a row of a symbol table that is wrong";
    UnknownParameter = "P0311" Error "a parameter that the block does not have";
    MissingParameter = "P0312" Error "a parameter that the call leaves out";
    DuplicateParameter = "P0313" Error "a parameter that the call supplies twice";
    NoMainBlock = "P0314" Error "a program without OB 1";
    UnknownType = "P0315" Error "a data type that nothing defines";
    DbMissing = "P0316" Warning "a data block that the program does not define";
    NoBlockFits = "P0317" Error "an instance data block of another function block";
    RecursiveType = "P0318" Error "a data type that contains itself";
    SafetyBlock = "P0325" Error "a block of a safety program";
    TypeMismatch = "P0401" Error "an actual parameter of another type";
    ConstantRequired = "P0402" Error "an operand that must be a constant";
    ArrayIndex = "P0403" Error "an index outside the bounds of its array";
    InitialValue = "P0404" Error "an initial value that does not fit its declaration";
    AddressRange = "P0405" Error "an address outside its area";
    CpuLimit = "P0406" Warning "more than the CPU has";
    DbRange = "P0407" Warning "an address beyond the end of its data block";
    WidthMismatch = "P0408" Error "an access whose width differs from the variable";
    LayoutTooLarge = "P0409" Error "a structure that is too large";
    SectionNotAllowed = "P0410" Error "a declaration section that the block kind cannot have";
    Protected = "P0411" Error "an operand that cannot be written";
    MissingPointer = "P0412" Warning "a parameter that must point somewhere is never supplied";
    OverlappingTags = "P0413" Warning "tags or addresses that share memory but not their kind";
    Nesting = "P0501" Error "parentheses that do not match";
    JumpIntoNesting = "P0502" Error "a jump into or out of parentheses";
    JumpList = "P0503" Error "a jump list that `JL` cannot use";
    ShiftCount = "P0504" Error "a shift count that the instruction does not have";
    CpuInstruction = "P0505" Error "an instruction that this CPU does not have";
    LabelWithoutStatement = "P0506" Error "a label with no instruction after it";
    EdgeBitLocal = "P0507" Warning "an edge memory bit in local data";
    CallInMcrZone = "P0508" Warning "a call with parameters inside an MCR zone";
    OverlappingActuals = "P0509" Warning "actual parameters that overlap";
    UnreachableCode = "P0510" Warning "a statement that is never reached";
    UnusedLabel = "P0511" Warning "a label that no jump names";
    TimerWithoutTime = "P0512" Warning "a timer or counter that starts without its value";
    OtherDataBlock = "P0513" Warning "an access to another data block than the one that was opened";
    Narrowing = "P0520" Warning "a value that may not fit where it goes";
    AlwaysSame = "P0521" Warning "a comparison or function with only one outcome";
    CaseValue = "P0522" Warning "a value of CASE that never matches";
    EndlessLoop = "P0523" Error "a loop that cannot end";
    LoopControl = "P0524" Error "EXIT or CONTINUE outside of a loop";
    LoopVariable = "P0525" Error "a FOR variable that its loop changes";
    JumpIntoStatement = "P0526" Error "a jump into a loop, an IF or a CASE";
    NeverWritten = "P0527" Warning "temporary data that is read before it is written";
    ValueNeverSet = "P0528" Warning "a function whose value is never set";
    MixedNumbers = "P0529" Warning "numbers of different kinds in one calculation";
    UnknownElement = "P0530" Error "an element of LAD or FBD that plcc does not know";
    ShortCircuit = "P0531" Error "a branch without an element";
    ReverseFlow = "P0532" Error "power that would flow from right to left";
    OpenBranch = "P0533" Error "a branch that leads nowhere";
    NoSource = "P0534" Error "a branch that nothing feeds";
    ElementPlace = "P0535" Error "an element in a position where it is not allowed";
    DoubleCoil = "P0536" Warning "an operand that two coils write";
    EdgeBit = "P0537" Warning "an edge memory bit that cannot do its work";
    ElementType = "P0538" Error "an element whose data type is not known or not possible";
    InstanceUse = "P0539" Warning "an instance that two elements share";
    GateInputs = "P0540" Error "a gate or pin of FBD that is not connected";
    ForeignContent = "P0541" Error "a part of an export that plcc does not read";
    TextResource = "P0542" Warning "a text of a network that cannot be found";
    MemoryByName = "P0543" Warning "clock or system memory that only the tag table mentions";
    MemoryTag = "P0544" Warning "a tag of the clock or system memory that the CPU does not set";
    ExtensionBlock = "P0545" Warning "a block that a chart calls besides its steps";
    AttributeValue = "P0546" Warning "an attribute that is misspelt or has a value that plcc does not know";
    DuplicateStep = "P0550" Error "a step or transition that is defined twice";
    ChartLimit = "P0551" Error "a chart that is larger than GRAPH allows";
    UnknownStep = "P0552" Error "a step or transition that the chart does not have";
    NoInitialStep = "P0553" Error "a sequencer without an initial step";
    UnreachableStep = "P0554" Error "a step that nothing reaches";
    InitialSteps = "P0555" Error "initial steps that exclude each other";
    DeadEnd = "P0556" Warning "a step that nothing leaves";
    NoFromStep = "P0557" Error "a transition that leaves no step";
    MissingCondition = "P0558" Error "a transition that is missing";
    ConditionType = "P0559" Error "a condition that is not a BOOL";
    ConstantCondition = "P0560" Warning "a condition that is always the same";
    NotExclusive = "P0561" Warning "alternative paths that may open together";
    ShortJump = "P0562" Warning "a jump to the step before it";
    UnmarkedJump = "P0563" Warning "a path back that is not drawn as a jump";
    SelfLoop = "P0564" Warning "a transition that leaves and enters the same step";
    BranchNeighbour = "P0565" Error "a branch between nodes that it cannot join";
    BranchArms = "P0566" Error "a branch that lacks arms";
    UnsafeBranch = "P0567" Error "a step that is entered while it is active";
    BranchJump = "P0568" Warning "a jump into or out of a simultaneous branch";
    DeadJoin = "P0569" Error "a join that can never switch";
    SharedOperand = "P0570" Warning "an operand that two active steps write";
    ActionEvent = "P0571" Error "an action whose event is missing or not possible";
    ActionText = "P0572" Error "an action that GRAPH does not have";
    ActionInterlock = "P0573" Error "an interlock at an event that has none";
    Qualifier = "P0574" Error "a qualifier that GRAPH does not have";
    ActionOperand = "P0575" Error "an action whose operand is of another type";
    NoInterlock = "P0576" Warning "the letter C in a step without interlock";
    NeverReset = "P0577" Warning "an operand that is set but never reset";
    TemporaryCondition = "P0578" Warning "a condition that reads temporary data";
    ChartInstance = "P0579" Error "a GRAPH block as a multi-instance";
    CalledTwice = "P0580" Warning "a GRAPH instance that is called twice";
    NoAcknowledgement = "P0581" Warning "a fault that nothing can acknowledge";
    NothingLeaves = "P0582" Warning "a loop that nothing leaves";
    IndexOfLoop = "P0583" Warning "a loop that goes beyond the bounds of an array";
    WholeDivision = "P0584" Warning "a division of whole numbers that loses its fraction";
    NegatedSide = "P0585" Warning "a comparison of which only one side is negated";
    NoEffect = "P0586" Warning "an assignment or operation that changes nothing";
    Project = "P0601" Error "a project file that cannot be used";
    UnknownCpu = "P0602" Error "a CPU that plcc does not know";
    Unreadable = "P0603" Error "a file that cannot be read";
    Station = "P0604" Error "a station that cannot be built";
    NoModule = "P0605" Warning "an address that no module of the station has";
    ModuleAccess = "P0606" Error "an access that a module does not allow";
    NotRead = "P0607" Warning "files of a folder that are not read";
    LeftOut = "P0615" Warning "a part that is left out because something that it needs is missing";
    Added = "P0616" Warning "components that the program uses but the data block does not declare";
    Pragma = "P0701" Error "an assertion pragma that cannot be understood";
    AssertionNotReached = "P0702" Error "an assertion that was never executed";
    StackUnderflow = "P0801" Error "a level of the logic stack that nothing has pushed";
    StackOverflow = "P0802" Warning "a level of the logic stack that was lost";
    NoContact = "P0803" Warning "a coil or box without a contact before it";
    LoopPair = "P0804" Error "a FOR without NEXT, or a NEXT without FOR";
    LoopNesting = "P0805" Error "FOR loops that are nested too deeply";
    StepPair = "P0806" Error "a sequence step that is not framed correctly";
    DuplicateSequenceStep = "P0807" Error "an S bit with two sequence steps";
    JumpAcrossStep = "P0808" Error "a jump into or out of a sequence step";
    InstructionPlace = "P0809" Error "an instruction that is not allowed in its block";
    TimerNumber = "P0810" Error "a timer number of another kind of timer";
    MixedCells = "P0811" Error "a timer or counter that instructions of two kinds run";
    CellTwice = "P0812" Warning "a timer or counter that two instructions run";
    ElementCount = "P0813" Error "a count that the instruction does not have";
    NumberRange = "P0814" Error "a number that the CPU does not have";
    CallDepth = "P0815" Warning "calls that may be nested too deeply";
    DataOverlap = "P0816" Warning "values of a data block that overlap";
    MixedFamilies = "P0817" Error "sources of the S7-200 among those of another family";
    LeftOverLevel = "P0818" Warning "a level of the logic stack that nothing uses";
    NotConverted = "P0901" Error "a part that the other notation cannot say";
}
