//! A function as the language has them: names that are given values once, conditions that choose values, loops that replace some names each turn.

/// A name: which of the function's.
pub type Id = u32;

/// A function in the language, or rather one for each number, vector or matrix that it gives back.
pub struct Made {
    /// What each number stands for.
    pub names: Vec<String>,
    /// Its parameters and their types.
    pub parameters: Vec<(Id, &'static str)>,
    /// Its results.
    pub results: Vec<MadeResult>,
    /// Which of its arguments it writes, each as so many results after those of its own value.
    pub written: Vec<(usize, usize)>,
    /// How many of the results are its own value.
    pub own: usize,
}

/// One of its results.
pub struct MadeResult {
    /// What it is called.
    pub name: String,
    /// Its type.
    pub ty: &'static str,
    /// Its value.
    pub body: Body,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Ex {
    /// A number.
    Number(f64),
    /// `true`, `false`.
    Bool(bool),
    /// A name of the function.
    Id(Id),
    /// A name of the file, or one that the language has.
    Global(String),
    /// A variable of the file that some function writes, where it is read before this one has written it: nothing can be said for it.
    Unknown(String),
    /// `name(arguments)`.
    Call(String, Vec<Ex>),
    /// `(a, b, c)`.
    Vector(Vec<Ex>),
    /// `-a`, `!a`.
    Unary(char, Box<Ex>),
    /// `a + b`.
    Binary(&'static str, Box<Ex>, Box<Ex>),
    /// `a.xz`.
    Part(Box<Ex>, String),
    /// `a[i]`.
    Index(Box<Ex>, Box<Ex>),
    /// `[a, b]`.
    List(Vec<Ex>),
    /// `if condition { … } else { … }`.
    If(Box<Ex>, Box<Body>, Box<Body>),
}

/// Names, and a value that is made of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// What is given names first.
    pub steps: Vec<Step>,
    /// The value.
    pub value: Ex,
}

impl Body {
    /// A value that needs no names.
    pub fn of(value: Ex) -> Box<Self> {
        Box::new(Self { steps: Vec::new(), value })
    }
}

/// What gives values to names.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// `let name = value;`
    Let(Id, Ex),
    /// What either side of a condition does, and which names have which values then.
    Branch {
        /// What decides.
        condition: Ex,
        /// Where it holds.
        yes: Vec<Step>,
        /// Where it does not.
        no: Vec<Step>,
        /// Each name with its value where the condition holds, and where it does not.
        outs: Vec<(Id, Ex, Ex)>,
    },
    /// `let a = first for index in from..to while condition { …; a = next };`
    Loop(Loop),
}

/// A loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// The turn's number.
    pub index: Id,
    /// The first.
    pub from: Ex,
    /// One past the last.
    pub to: Ex,
    /// It ends before the first turn at which this is false.
    pub condition: Option<Ex>,
    /// Names within.
    pub steps: Vec<Step>,
    /// What is replaced each turn: the name, its first value, and its next.
    pub turns: Vec<(Id, Ex, Ex)>,
}

impl Ex {
    /// A number that is an integer of a few digits, a name, and the like: as short as a name for it would be.
    pub fn is_short(&self) -> bool {
        match self {
            Ex::Number(_) | Ex::Bool(_) | Ex::Id(_) | Ex::Global(_) | Ex::Unknown(_) => true,
            Ex::Part(of, _) => of.is_short(),
            Ex::Unary(_, of) => matches!(**of, Ex::Number(_) | Ex::Id(_)),
            _ => false,
        }
    }

    /// Calls `f` for the expressions in it, not for those within steps.
    pub fn each(&self, f: &mut impl FnMut(&Ex)) {
        f(self);
        match self {
            Ex::Number(_) | Ex::Bool(_) | Ex::Id(_) | Ex::Global(_) | Ex::Unknown(_) => {}
            Ex::Call(_, all) | Ex::Vector(all) | Ex::List(all) => all.iter().for_each(|ex| ex.each(f)),
            Ex::Unary(_, of) | Ex::Part(of, _) => of.each(f),
            Ex::Binary(_, a, b) | Ex::Index(a, b) => [a, b].into_iter().for_each(|ex| ex.each(f)),
            Ex::If(condition, yes, no) => {
                condition.each(f);
                for body in [yes, no] {
                    each_of(&body.steps, f);
                    body.value.each(f);
                }
            }
        }
    }

    /// The same with expressions replaced where `f` has something for them.
    pub fn map(&self, f: &mut impl FnMut(&Ex) -> Option<Ex>) -> Ex {
        if let Some(other) = f(self) {
            return other;
        }
        match self {
            Ex::Number(_) | Ex::Bool(_) | Ex::Id(_) | Ex::Global(_) | Ex::Unknown(_) => self.clone(),
            Ex::Call(name, all) => Ex::Call(name.clone(), all.iter().map(|ex| ex.map(f)).collect()),
            Ex::Vector(all) => Ex::Vector(all.iter().map(|ex| ex.map(f)).collect()),
            Ex::List(all) => Ex::List(all.iter().map(|ex| ex.map(f)).collect()),
            Ex::Unary(op, of) => Ex::Unary(*op, Box::new(of.map(f))),
            Ex::Part(of, part) => part_of(of.map(f), part),
            Ex::Binary(op, a, b) => Ex::Binary(op, Box::new(a.map(f)), Box::new(b.map(f))),
            Ex::Index(a, b) => Ex::Index(Box::new(a.map(f)), Box::new(b.map(f))),
            Ex::If(condition, yes, no) => {
                let condition = Box::new(condition.map(f));
                let [yes, no] = [yes, no].map(|body| Box::new(Body { steps: map_of(&body.steps, f), value: body.value.map(f) }));
                Ex::If(condition, yes, no)
            }
        }
    }

    /// Whether a name is read in it.
    pub fn reads(&self, id: Id) -> bool {
        let mut found = false;
        self.each(&mut |ex| found |= *ex == Ex::Id(id));
        found
    }
}

/// Components of a vector; of one that is written out, those themselves.
pub fn part_of(of: Ex, part: &str) -> Ex {
    let place = |letter: char| "xyzw".find(letter);
    match &of {
        Ex::Vector(all) => {
            let picked: Option<Vec<Ex>> = part.chars().map(|letter| all.get(place(letter)?).cloned()).collect();
            match picked.as_deref() {
                Some([one]) => return one.clone(),
                Some(many) if many.iter().all(Ex::is_short) => return Ex::Vector(many.to_vec()),
                _ => {}
            }
        }
        Ex::Part(inner, before) => {
            let before: Vec<char> = before.chars().collect();
            let picked: Option<String> = part.chars().map(|letter| before.get(place(letter)?).copied()).collect();
            if let Some(picked) = picked {
                return part_of((**inner).clone(), &picked);
            }
        }
        _ => {}
    }
    Ex::Part(Box::new(of), part.to_owned())
}

/// Calls `f` for the expressions of steps.
pub fn each_of(steps: &[Step], f: &mut impl FnMut(&Ex)) {
    for step in steps {
        match step {
            Step::Let(_, value) => value.each(f),
            Step::Branch { condition, yes, no, outs } => {
                condition.each(f);
                each_of(yes, f);
                each_of(no, f);
                for (_, a, b) in outs {
                    a.each(f);
                    b.each(f);
                }
            }
            Step::Loop(turn) => {
                turn.from.each(f);
                turn.to.each(f);
                turn.condition.iter().for_each(|ex| ex.each(f));
                for (_, first, next) in &turn.turns {
                    first.each(f);
                    next.each(f);
                }
                each_of(&turn.steps, f);
            }
        }
    }
}

/// Steps with expressions replaced.
pub fn map_of(steps: &[Step], f: &mut impl FnMut(&Ex) -> Option<Ex>) -> Vec<Step> {
    let mut mapped = Vec::with_capacity(steps.len());
    for step in steps {
        mapped.push(match step {
            Step::Let(id, value) => Step::Let(*id, value.map(f)),
            Step::Branch { condition, yes, no, outs } => Step::Branch {
                condition: condition.map(f),
                yes: map_of(yes, f),
                no: map_of(no, f),
                outs: outs.iter().map(|(id, a, b)| (*id, a.map(f), b.map(f))).collect(),
            },
            Step::Loop(turn) => Step::Loop(Loop {
                index: turn.index,
                from: turn.from.map(f),
                to: turn.to.map(f),
                condition: turn.condition.as_ref().map(|ex| ex.map(f)),
                steps: map_of(&turn.steps, f),
                turns: turn.turns.iter().map(|(id, first, next)| (*id, first.map(f), next.map(f))).collect(),
            }),
        });
    }
    mapped
}
