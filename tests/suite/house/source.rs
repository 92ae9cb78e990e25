//! Reads Rust source far enough to know which paths it names, and where.
//!
//! It knows comments, literals, nested `use` lists, inline modules, `self` and `super`; it does not know macros'
//! expansions or what a glob brings in. That is enough for laws about who may name whom.

/// A path as the source names it, with `self` and `super` resolved: `crate::sphere::Vmf`, `std::thread::spawn`, `x`.
#[derive(Debug, PartialEq)]
pub struct Mention {
    /// Counted from one.
    pub line: usize,
    pub path: Vec<String>,
}

/// Every path named by `code`, the source of `module` (`["gpu", "frame"]`; the crate's root is empty).
pub fn mentions(code: &str, module: &[String]) -> Vec<Mention> {
    let mut reader = Reader {
        tokens: tokens(&without_text(code)),
        at: 0,
        module: module.to_vec(),
        scopes: Vec::new(),
        found: Vec::new(),
    };
    while reader.at < reader.tokens.len() {
        reader.step();
    }
    reader.found
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Word(String),
    /// `::`
    Join,
    Sign(char),
}

struct Reader {
    tokens: Vec<(usize, Token)>,
    at: usize,
    /// The module that the reader stands in.
    module: Vec<String>,
    /// One for every open brace: whether it opened a module.
    scopes: Vec<bool>,
    found: Vec<Mention>,
}

impl Reader {
    fn step(&mut self) {
        match self.peek(0) {
            Some(Token::Word(word)) if word == "mod" => self.enter_module(),
            Some(Token::Word(_)) => self.read_path(&[]),
            Some(Token::Sign('{')) => {
                self.scopes.push(false);
                self.at += 1;
            }
            Some(Token::Sign('}')) => {
                if self.scopes.pop() == Some(true) {
                    self.module.pop();
                }
                self.at += 1;
            }
            _ => self.at += 1,
        }
    }

    fn peek(&self, ahead: usize) -> Option<&Token> {
        self.tokens.get(self.at + ahead).map(|(_, token)| token)
    }

    /// At `mod`: steps into `mod name {`, over `mod name;`.
    fn enter_module(&mut self) {
        if let (Some(Token::Word(name)), Some(Token::Sign('{'))) = (self.peek(1), self.peek(2)) {
            self.module.push(name.clone());
            self.scopes.push(true);
            self.at += 3;
        } else {
            self.at += 2;
        }
    }

    /// At the first word of a path, whose beginning is `before` when it stands in a list.
    fn read_path(&mut self, before: &[String]) {
        let line = self.tokens[self.at].0;
        let mut path = before.to_vec();
        loop {
            match self.peek(0) {
                Some(Token::Word(word)) => path.push(word.clone()),
                Some(Token::Sign('*')) => path.push("*".to_owned()),
                Some(Token::Sign('{')) => return self.read_list(&path),
                // A path's end by something else: a turbofish.
                _ => break,
            }
            self.at += 1;
            if self.peek(0) != Some(&Token::Join) {
                break;
            }
            self.at += 1;
        }
        self.found.push(Mention { line, path: resolved(path, &self.module) });
    }

    /// At the `{` of a list of paths that all begin with `before`.
    fn read_list(&mut self, before: &[String]) {
        self.at += 1;
        while let Some(token) = self.peek(0) {
            match token {
                Token::Sign('}') => {
                    self.at += 1;
                    return;
                }
                // `name as other`: the other name is a new one, no path.
                Token::Word(word) if word == "as" => self.at += 2,
                Token::Word(_) | Token::Sign('*' | '{') => self.read_path(before),
                _ => self.at += 1,
            }
        }
    }
}

/// The path from the crate's root, if it began with `self` or `super` inside `module`.
fn resolved(mut path: Vec<String>, module: &[String]) -> Vec<String> {
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let ups = path.iter().take_while(|word| *word == "super").count();
    let selves = usize::from(path[0] == "self" && path.len() > 1);
    if ups + selves == 0 {
        return path;
    }
    let mut whole = vec!["crate".to_owned()];
    whole.extend_from_slice(&module[..module.len().saturating_sub(ups)]);
    whole.extend(path.split_off(ups + selves));
    whole
}

fn tokens(code: &str) -> Vec<(usize, Token)> {
    let mut found = Vec::new();
    for (index, text) in code.lines().enumerate() {
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let length = if is_word(first) {
                let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
                found.push((index + 1, Token::Word(rest[..length].to_owned())));
                length
            } else if rest.starts_with("::") {
                found.push((index + 1, Token::Join));
                2
            } else {
                if !first.is_whitespace() {
                    found.push((index + 1, Token::Sign(first)));
                }
                first.len_utf8()
            };
            rest = &rest[length..];
        }
    }
    found
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The code with its comments and literals taken out and its lines kept.
fn without_text(code: &str) -> String {
    let mut kept = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let inside_word = kept.ends_with(is_word);
        let skipped = text_length(rest, inside_word);
        if skipped == 0 {
            kept.push(first);
            rest = &rest[first.len_utf8()..];
        } else {
            kept.push(' ');
            kept.extend(rest[..skipped].matches('\n').map(|_| '\n'));
            rest = &rest[skipped..];
        }
    }
    kept
}

/// The length of the comment or literal that `rest` begins with, 0 if it begins with code.
fn text_length(rest: &str, inside_word: bool) -> usize {
    if rest.starts_with("//") {
        rest.find('\n').unwrap_or(rest.len())
    } else if rest.starts_with("/*") {
        block_comment_length(rest)
    } else if rest.starts_with('"') {
        quoted_length(rest, '"')
    } else if rest.starts_with('\'') {
        quote_length(rest)
    } else if inside_word {
        0
    } else {
        raw_string_length(rest)
    }
}

/// Block comments nest.
fn block_comment_length(rest: &str) -> usize {
    let (mut at, mut depth) = (2, 1);
    while depth > 0 && at < rest.len() {
        let here = &rest[at..];
        if here.starts_with("/*") {
            depth += 1;
            at += 2;
        } else if here.starts_with("*/") {
            depth -= 1;
            at += 2;
        } else {
            at += here.chars().next().map_or(1, char::len_utf8);
        }
    }
    at
}

/// A character's literal, or only the mark of a lifetime's name.
fn quote_length(rest: &str) -> usize {
    let mut after = rest.chars().skip(1);
    let is_character = after.next() == Some('\\') || after.next() == Some('\'');
    if is_character { quoted_length(rest, '\'') } else { 1 }
}

fn quoted_length(rest: &str, mark: char) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if escaped {
            escaped = false;
        } else if c == '\\' {
            escaped = true;
        } else if c == mark {
            return at + 1;
        }
    }
    rest.len()
}

/// `r"…"`, `r#"…"#`, and the same with `b` or `c` before; 0 for anything else.
fn raw_string_length(rest: &str) -> usize {
    let Some(marked) = rest.strip_prefix('r').or_else(|| rest.strip_prefix("br")).or_else(|| rest.strip_prefix("cr"))
    else {
        return 0;
    };
    let hashes = marked.len() - marked.trim_start_matches('#').len();
    let Some(text) = marked[hashes..].strip_prefix('"') else {
        return 0;
    };
    let end = format!("\"{}", "#".repeat(hashes));
    let start = rest.len() - text.len();
    text.find(&end).map_or(rest.len(), |at| start + at + end.len())
}

fn paths_of(code: &str, module: &[&str]) -> Vec<String> {
    let module: Vec<String> = module.iter().map(ToString::to_string).collect();
    mentions(code, &module)
        .into_iter()
        .map(|mention| mention.path.join("::"))
        .filter(|path| path.contains("::"))
        .collect()
}

#[test]
fn a_list_of_imports_is_read_name_by_name() {
    let code = "use crate::{color, filter::{self, vmf::{Em, Seed as Start}}, scene::*};";
    assert_eq!(
        paths_of(code, &["app"]),
        ["crate::color", "crate::filter", "crate::filter::vmf::Em", "crate::filter::vmf::Seed", "crate::scene::*"]
    );
}

#[test]
fn a_path_inside_an_expression_or_a_type_is_read() {
    let code = "fn f(x: &crate::gpu::Frame<crate::ndf::Ndf>) -> u8 { crate::jobs::start::<u8>(x) }";
    assert_eq!(paths_of(code, &["app"]), ["crate::gpu::Frame", "crate::ndf::Ndf", "crate::jobs::start"]);
}

#[test]
fn comments_and_literals_name_nothing() {
    let code = r##"
        //! crate::a
        /* crate::b /* crate::c */ crate::d */
        const TEXT: &str = "crate::e \" crate::f";
        const RAW: &str = r#"crate::g " crate::h"#;
        const MARK: char = '"';
        fn f<'a>(x: &'a u8) -> crate::found::X<'a> { '\'' }
    "##;
    assert_eq!(paths_of(code, &[]), ["crate::found::X"]);
}

#[test]
fn a_line_is_counted_from_one_over_comments_and_literals() {
    let code = "/* one\ntwo */\nconst X: &str = \"three\nfour\";\nuse a::b;";
    let found = mentions(code, &[]);
    assert_eq!(found.last(), Some(&Mention { line: 5, path: vec!["a".to_owned(), "b".to_owned()] }));
}

#[test]
fn a_way_up_by_super_is_followed() {
    let code = "use super::Method; use super::super::gpu::Frame; mod tests { use super::*; use super::super::x; } use self::y::z;";
    assert_eq!(
        paths_of(code, &["filter", "lean"]),
        [
            "crate::filter::Method",
            "crate::gpu::Frame",
            "crate::filter::lean::*",
            "crate::filter::x",
            "crate::filter::lean::y::z"
        ]
    );
}
