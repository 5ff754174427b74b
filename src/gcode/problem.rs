//! What can be wrong with a line, in words for whoever wrote it.

/// What is wrong with a place in a program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A character that begins no word.
    #[error("{0:?} begins no word; words are a letter and a number, like X12.5")]
    Character(char),
    /// A letter without a number behind it.
    #[error("no number after {letter}; words are a letter and a number, like X12.5")]
    NoNumber {
        /// The letter.
        letter: char,
    },
    /// A parameter or an expression.
    #[error("parameters and expressions (# and [ ]) are not read yet; write the number itself")]
    Expression,
    /// `(` without `)`.
    #[error("this comment is not closed; add a ) on the same line")]
    OpenComment,
    /// A line no control would take.
    #[error("the line is longer than {limit} bytes; this is no program a control would read")]
    LineTooLong {
        /// The most a line may have.
        limit: usize,
    },
    /// A word that is not understood.
    #[error("{word} is not read yet; the reader knows {known}")]
    Unknown {
        /// The word.
        word: String,
        /// What is known of its kind.
        known: &'static str,
    },
    /// An arc.
    #[error("{word} arcs are not read yet; write them as short straight moves")]
    Arc {
        /// The word.
        word: String,
    },
    /// A word a line has already.
    #[error("the line has {letter} twice")]
    Twice {
        /// The letter.
        letter: char,
    },
    /// Two words of one modal group.
    #[error("{second} contradicts {first} on the same line; keep one of them")]
    Conflict {
        /// The word that stands first.
        first: String,
        /// The word that contradicts it.
        second: String,
    },
    /// A word of an axis the machine has not.
    #[error("the machine has no axis {letter}; it has {axes}")]
    NoSuchAxis {
        /// The letter.
        letter: char,
        /// The axes there are.
        axes: String,
    },
    /// Axis words, but nothing says how to move.
    #[error("axis words, but neither G0 nor G1 is in force here")]
    NoMotion,
    /// A feed move under inverse time without its own F.
    #[error("F word missing with inverse time G1 move; under G93 each G1 block needs its own F")]
    NoInverseTimeFeed,
    /// A feed move before any feed.
    #[error("G1 with zero feed rate: no F since the program began or G93 ended; add one")]
    NoFeed,
    /// A number that must be greater than zero, or not below it.
    #[error("{letter}{value} is out of range: it must be {bound}")]
    Range {
        /// The letter of the word.
        letter: char,
        /// Its number.
        value: f64,
        /// What it must be.
        bound: &'static str,
    },
    /// A dwell without its time.
    #[error("G4 without {letter}: say how long to wait, like G4 {letter}0.5")]
    NoDwellTime {
        /// The letter of the time.
        letter: char,
    },
    /// A dwell and axis words at once.
    #[error("G4 and axis words on one line; put the move on a line of its own")]
    DwellMoves,
    /// A tool change without a tool.
    #[error("M6 without a tool: no T word up to here")]
    NoTool,
    /// An increment from an unknown position.
    #[error("an increment (G91) of {letter}, which has had no position yet; give it one under G90")]
    UnknownStart {
        /// The axis.
        letter: char,
    },
    /// F under inverse time, but no feed move.
    #[error("F under G93 is the time of a G1 block, and this line has none")]
    StrayFeed,
    /// P without a dwell.
    #[error("P belongs to G4, and this line has none")]
    StrayTime,
    /// Whole turns alone can be taken off.
    #[error("G92 is read where it takes whole turns off a rotary axis, and here it does not")]
    Rezero,
    /// A program stop that is no tool change.
    #[error("{word} is read behind a T word, where tools are changed by hand, and not here")]
    Stop {
        /// The word.
        word: &'static str,
    },
    /// What plain text has no such line for.
    #[error(
        "{word} begins no line that is read; the reader knows BEGIN PGM, END PGM, L, TOOL CALL, \
         CYCL DEF 9, M words, comments, and what the dialect lists"
    )]
    Klartext {
        /// The word.
        word: String,
    },
    /// A dialect's modal line holds something else.
    #[error("modal words alone belong here, like G21 G90; programs are in millimetres, absolute")]
    NotModal,
}
