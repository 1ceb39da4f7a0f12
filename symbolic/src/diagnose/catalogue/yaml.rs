//! E001–: YAML itself.

super::entries! {
    E001 not_yaml(what, help) "not YAML"
        "this is not YAML: {what}" "here" "{help}"
        "The file breaks YAML's own rules, so nothing else in it is judged.";
    E002 unquoted(help) "an expression that YAML took apart"
        "YAML takes this apart" "YAML stops reading the expression here" "{help}"
        "Commas and brackets inside `{…}` or `[…]`, and a leading `[`, `*`, `&`, quote or `- `, mean something to YAML. Put the expression in double quotes.";
    E003 duplicate_key(key, line) "a key given twice"
        "the key `{key}` is given twice" "it is already given in line {line}" "remove one of the two"
        "Each key of a mapping may stand there once.";
    E004 anchor() "an anchor"
        "anchors (`&name`) are not used in model files" "an anchor" "if this is an expression, put it in double quotes"
        "A model file says each thing in place; names and `define` are there for what is used twice.";
    E005 alias() "an alias"
        "aliases (`*name`) are not used in model files" "an alias" "if this is an expression, put it in double quotes"
        "A model file says each thing in place; names and `define` are there for what is used twice.";
    E006 merge_key() "a merge key"
        "merge keys (`<<`) are not used in model files" "a merge key" "write the entries out"
        "A model file says each thing in place.";
    E007 tag(tag) "a tag"
        "tags (`{tag}`) are not used in model files" "a tag" "if this is an expression, put it in double quotes"
        "The kind of a value follows from where it stands.";
    E008 not_finite(text) "a number that is not finite"
        "`{text}` is not a number that a model can use" "not finite" "leave the entry out, or write a large number"
        "YAML's `.inf` and `.nan` are refused, as is a number too large for 64-bit floating point.";
    E009 not_decimal(text) "a hexadecimal, octal or binary number"
        "`{text}` is not a decimal number" "not decimal" "write it in decimal"
        "Numbers are read as decimal text, so that 0.1 is exactly 1/10.";
    E010 nested_too_deeply(limit) "nested too deeply"
        "nested deeper than {limit} levels" "" ""
        "No model needs it; the limit keeps a hostile file from exhausting the stack.";
    E011 too_large(size, limit) "a file too large"
        "the file has {size} bytes, the limit is {limit}" "" ""
        "The limit keeps a hostile file from exhausting memory.";
    E012 several_documents() "several documents"
        "a model file holds one document" "a second one starts here" "put each model in a file of its own"
        "`---` starts a new YAML document; a file describes one model.";
    E013 key_not_text() "a key that is not text"
        "a key must be a name, not a list or mapping" "" "if this is an expression, put it in double quotes"
        "`[a]: …` and `{a}: …` as keys mean nothing here.";
    E014 not_a_mapping(found) "a file that is no mapping"
        "a model file is a mapping of keys such as `name` and `coordinates`, this is {found}" "" ""
        "At the outermost level a model file says `name: …`, `coordinates: …` and so on.";
    E015 open_quote(quote, help) "a quote that is not closed"
        "this `{quote}` is not closed" "opened here" "{help}"
        "A value that starts with a quote ends with the same quote, and a quote inside it ends it.";
    E016 open_collection(bracket, closing) "a list or mapping that is not closed"
        "this `{bracket}` is not closed" "opened here" "close it with `{closing}`"
        "`[…]` and `{…}` may go over several lines and must be closed.";
    E017 folded_prime(written, read) "two primes in single quotes"
        "in single quotes YAML reads `''` as one `'`: `{written}` becomes `{read}`" "one prime is lost" "put the expression in double quotes: `\"{written}\"`, or with one prime if a velocity is meant"
        "A quote inside single quotes is written twice, so that an acceleration would silently become a velocity.";
    E018 no_pair(written, meant) "a key that is not parted from its value"
        "`{written}` is no `key: value`" "" "write `{meant}`"
        "A colon and a blank stand between a key and its value; without the blank, or with `=`, YAML takes both for one text.";
}
