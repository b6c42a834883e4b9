/**
 * The syntax of .sid files for editors that use syntax trees, following grammar/sid.pest statement by statement.
 *
 * Line ends do not end statements here. Where a statement could continue on the next line (`sin x` before `dy ~ …`), both parses are tried.
 * tests/it/editor compares the trees with the compiler. `tree-sitter generate` rewrites src/.
 */
/* global grammar, seq, choice, repeat, repeat1, optional, field, alias, token, prec */

const listed = (rule) => seq(rule, repeat(seq(",", rule)));

module.exports = grammar({
  name: "sid",

  word: ($) => $.name,

  extras: ($) => [/[ \t\r\n\u00A0\uFEFF]/, $.comment],

  conflicts: ($) => [
    [$.unknown, $.attribute],
    [$._item, $.group],
    [$.attribute],
    // `sin` may be a name or a call without brackets; `sin^2` a power of a name, or of a function.
    [$._primary, $.call, $.application],
    [$._primary, $.application],
    [$._raised, $._to],
    // `unknown a, b` and `unknown a, hidden`.
    [$.unknown],
  ],

  rules: {
    source_file: ($) => repeat($._statement),

    _statement: ($) =>
      choice(
        $.version,
        $.system,
        $.declaration,
        $.unknown,
        $.constant,
        $.function,
        $.data,
        $.constraint,
        $.per_run,
        $.symmetry,
        $.reset,
        $.limit,
        $.preference,
        $.include,
        $.equation,
      ),

    version: ($) => seq("sidc", $.number),
    system: ($) => seq("system", field("name", alias($.name, $.system_name))),

    declaration: ($) =>
      seq(field("kind", choice("state", "input", "output", "param")), $.names, optional(seq(":", listed($.attribute)))),
    unknown: ($) =>
      seq(
        "unknown",
        listed(field("name", $.name)),
        optional($._within),
        optional(seq(choice(":", ","), listed($.attribute))),
      ),
    attribute: ($) =>
      choice(
        seq(field("name", alias($.name, $.attribute_name)), optional(choice($._within, $._expression))),
        seq("per", choice("run", $._expression)),
      ),
    _within: ($) => seq("in", $._expression, "..", $._expression),

    constant: ($) => seq("let", field("name", $.name), "=", $._expression),
    function: ($) => seq("let", field("name", alias($.name, $.function_name)), "(", listed(field("argument", $.name)), ")", "=", $._expression),

    equation: ($) => seq(field("target", $.targets), field("relation", choice("~", "=")), $._expression, optional($.over)),
    over: ($) => seq(",", field("index", $.name), "=", $._end, "..", $._end, optional("cyclic")),
    _end: ($) => choice($.name, $.number),

    data: ($) => seq("data", "{", repeat(choice($.source, $.step, ";")), "}"),
    step: ($) => seq("step", $._expression),
    source: ($) => seq(field("name", choice(alias($.name, $.column), alias("step", $.column), "run")), "=", choice("none", listed($._expression))),

    constraint: ($) => seq("constrain", $._expression, repeat1(seq($.relation, $._expression)), optional($.over)),
    per_run: ($) => seq(choice(seq("coef", $.arguments, repeat(seq(",", $._target))), seq("constrain", $.targets)), ":", $.attribute, optional($.over)),
    relation: () => choice("<=", ">=", "<", ">", "="),

    symmetry: ($) => seq("symmetry", choice($.names, seq("(", $.names, ")")), "->", choice($.names, $.flipped)),
    flipped: ($) => seq("-", "(", $.names, ")"),
    reset: ($) => seq("when", $._expression, $.relation, $._expression, ":", listed($.jump)),
    jump: ($) => seq(field("name", $.name), "->", $._expression),
    limit: ($) => seq("limit", listed($.attribute)),
    preference: ($) => seq("prefer", $.attribute),
    include: ($) => seq("include", field("path", $.text)),

    // The targets of an equation: `dx`, `dx[i]`, `next(x)`, `x1 .. x4`.
    targets: ($) => listed(choice($._target, alias($.target_range, $.range))),
    _target: ($) => choice($.name, $.element, $.call, $.application),
    target_range: ($) => seq($._target, "..", $._target),
    names: ($) => listed($._item),
    _item: ($) => choice($._expression, $.range),
    range: ($) => seq($._expression, "..", $._expression),

    _expression: ($) => choice($.binary, $.negation, $.power, $._primary),
    binary: ($) =>
      choice(
        prec.left(1, seq($._expression, field("operator", choice("+", "-")), $._expression)),
        prec.left(2, seq($._expression, field("operator", choice("*", "/")), $._expression)),
      ),
    negation: ($) => prec(3, seq("-", $._expression)),
    power: ($) => prec(4, seq(choice($._primary, $.power), $._raised)),
    _raised: ($) => seq("^", optional("-"), choice($.number, $.name, $.group)),

    _primary: ($) => choice($.share, $.number, $.name, $.element, $.call, $.application, $.list, $.group, $.text),
    group: ($) => seq("(", $._expression, ")"),
    list: ($) => seq("<", listed($._item), optional(","), ">"),
    element: ($) => seq(field("name", $.name), "[", $._expression, "]"),
    call: ($) => seq(field("function", alias($.name, $.function_name)), optional($._to), $.arguments),
    // `sin theta`, `sin^2 theta`
    application: ($) => seq(field("function", alias($.name, $.function_name)), optional($._to), field("argument", $.name)),
    _to: ($) => seq("^", optional("-"), $.number),
    arguments: ($) =>
      seq("(", optional(seq(listed($._item), optional(","))), optional(seq(";", listed($._item), optional(","))), ")"),

    name: () => /[A-Za-z_\p{L}\p{Nl}][A-Za-z0-9_\p{L}\p{Nl}\p{M}]*'*/,
    number: () => /[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?/,
    share: () => /[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?%/,
    text: () => /"[^"\n]*"/,
    comment: () => token(seq("#", /[^\n]*/)),
  },
});
