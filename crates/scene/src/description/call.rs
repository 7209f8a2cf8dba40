//! The language of one-line descriptions: nested calls with named values.
//!
//!   call  = name | name "(" [ value { "," value } ] ")" | name ":" value { ":" value }
//!   value = [ key "=" ] ( call | "[" value { "," value } "]" | text )
//!
//! A text runs to the next of `, ( ) [ ]` or stands in quotes; blanks around it do not count. `hg(g=0.85)`, `hg(0.85)`
//! and `hg:0.85` are the same call. Names and keys are of letters, digits, `_` and `-`, which are one.

/// A call such as `gamma(r_eff=10um, v_eff=0.1)`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Call {
    pub name: String,
    pub arguments: Vec<Argument>,
}

/// A value that is given to a call.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Argument {
    /// None for a value that is given by its place.
    pub key: Option<String>,
    pub term: Term,
}

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Term {
    Text(String),
    List(Vec<Term>),
    Call(Call),
}

/// Calls within calls; more is a mistake, and would run out of stack at last.
const GREATEST_DEPTH: usize = 8;

/// Reads a call, or says what is wrong with the text.
pub(super) fn parse(text: &str) -> Result<Call, String> {
    let mut parser = Parser { rest: text.trim() };
    let name = parser.name();
    if name.is_empty() {
        return Err("starts with no name; write one such as hg(g=0.85)".into());
    }
    let arguments = if parser.rest.starts_with(':') {
        let values = parser.rest[1..].split(':').map(|part| {
            let mut parser = Parser { rest: part.trim() };
            let argument = parser.argument(1)?;
            parser.end().map(|()| argument)
        });
        values.collect::<Result<_, _>>()?
    } else {
        let arguments = parser.parentheses(1)?;
        parser.end()?;
        arguments
    };
    Ok(Call { name, arguments })
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn eat(&mut self, symbol: char) -> bool {
        match self.rest.trim_start().strip_prefix(symbol) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn end(&self) -> Result<(), String> {
        match self.rest.trim() {
            "" => Ok(()),
            rest => Err(format!("`{rest}` is left over at the end; remove it or mend the brackets")),
        }
    }

    /// Takes letters, digits, `_` and `-`; nothing if there are none.
    fn name(&mut self) -> String {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        let length = self.rest.find(|c| !is_part(c)).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(length);
        self.rest = rest.trim_start();
        name.to_ascii_lowercase().replace('-', "_")
    }

    /// The arguments in parentheses, if there are any.
    fn parentheses(&mut self, depth: usize) -> Result<Vec<Argument>, String> {
        let mut arguments = Vec::new();
        if !self.eat('(') || self.eat(')') {
            return Ok(arguments);
        }
        loop {
            arguments.push(self.argument(depth)?);
            if self.eat(')') {
                return Ok(arguments);
            }
            if !self.eat(',') {
                return Err("lacks `)` or a `,` between two values".into());
            }
        }
    }

    fn argument(&mut self, depth: usize) -> Result<Argument, String> {
        let before = self.rest;
        let key = self.name();
        let key = if !key.is_empty() && self.eat('=') {
            Some(key)
        } else {
            self.rest = before;
            None
        };
        Ok(Argument { key, term: self.term(depth)? })
    }

    fn term(&mut self, depth: usize) -> Result<Term, String> {
        if depth > GREATEST_DEPTH {
            return Err(format!("is nested more than {GREATEST_DEPTH} deep"));
        }
        for quote in ['"', '\''] {
            if self.eat(quote) {
                let Some((text, rest)) = self.rest.split_once(quote) else {
                    return Err(format!("lacks the closing {quote}"));
                };
                self.rest = rest;
                return Ok(Term::Text(text.to_owned()));
            }
        }
        if self.eat('[') {
            let mut items = Vec::new();
            while !self.eat(']') {
                if !items.is_empty() && !self.eat(',') {
                    return Err("lacks `]` or a `,` between two values".into());
                }
                items.push(self.term(depth + 1)?);
            }
            return Ok(Term::List(items));
        }
        let length = self.rest.find([',', '(', ')', '[', ']']).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(length);
        let text = text.trim();
        if text.is_empty() {
            return Err("lacks a value; write key=value".into());
        }
        if !rest.starts_with('(') {
            self.rest = rest;
            return Ok(Term::Text(text.to_owned()));
        }
        let name = self.name();
        if !self.rest.starts_with('(') {
            return Err(format!("`{text}` is no name that could stand before `(`"));
        }
        Ok(Term::Call(Call { name, arguments: self.parentheses(depth + 1)? }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Term {
        Term::Text(text.into())
    }

    fn argument(key: &str, term: Term) -> Argument {
        Argument { key: (!key.is_empty()).then(|| key.into()), term }
    }

    #[test]
    fn calls_nest_and_take_lists_and_quotes() {
        let call =
            parse(" Two-Term ( a = 1.33+1e-5i , list=[0, -1,2],inner=gamma( r_eff=10um,0.1), 'a, (b)' ) ");
        let inner = Call {
            name: "gamma".into(),
            arguments: vec![argument("r_eff", text("10um")), argument("", text("0.1"))],
        };
        let arguments = vec![
            argument("a", text("1.33+1e-5i")),
            argument("list", Term::List(vec![text("0"), text("-1"), text("2")])),
            argument("inner", Term::Call(inner)),
            argument("", text("a, (b)")),
        ];
        assert_eq!(call, Ok(Call { name: "two_term".into(), arguments }));
    }

    #[test]
    fn parentheses_and_colons_say_the_same() {
        assert_eq!(parse("hg:0.85"), parse("hg(0.85)"));
        assert_eq!(parse("mie:water:10um:gamma(0.1)"), parse("mie(water,10um,gamma(0.1))"));
        assert_eq!(parse("rayleigh"), parse("rayleigh()"));
    }

    #[test]
    fn what_is_no_call_is_told() {
        for (text, word) in [
            ("", "no name"),
            ("(g=1)", "no name"),
            ("hg(g=1", "`)`"),
            ("hg(g=1))", "`)` is left over"),
            ("hg(g=)", "lacks a value"),
            ("hg(,)", "lacks a value"),
            ("hg:", "lacks a value"),
            ("a(b=[1,2)", "`]`"),
            ("a(b=[1 [2])", "`]`"),
            ("a(b='c)", "closing '"),
            ("a(b/c(1))", "no name"),
            ("hg g=1", "left over"),
            (&"a(".repeat(100_000), "deep"),
            (&format!("a({}", "[".repeat(100_000)), "deep"),
        ] {
            let error = parse(text).expect_err(text);
            assert!(error.contains(word), "{error}");
        }
    }
}
