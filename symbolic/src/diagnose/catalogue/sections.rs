//! E301–: the shape of a file: keys, values, lists.

super::entries! {
    E301 unknown_key(key, section, help) "an unknown key"
        "unknown key `{key}` in {section}" "" "{help}"
        "Every key is checked, so that a slip of the pen is not silently ignored.";
    E302 missing_key(key, section) "a missing key"
        "`{key}` is missing in {section}" "needs `{key}`" ""
        "Some keys must be there.";
    E303 missing_value(key) "a missing value"
        "`{key}` has no value" "expected a value after the colon" ""
        "An empty value means \"no unit\" in `coordinates`, and is an error elsewhere.";
    E304 wrong_shape(context, wanted, found) "a list, mapping or text in the wrong place"
        "{context} must be {wanted}, this is {found}" "expected {wanted}" ""
        "Each key has its form; see LANGUAGE.md, section 3.";
    E305 conflicting_keys(first, second, section) "two keys that exclude each other"
        "`{first}` and `{second}` cannot both be given in {section}" "" "keep one of the two"
        "They say the same thing in two ways.";
    E306 needs_one_of(keys, section) "one of several keys is needed"
        "{section} needs one of {keys}" "" ""
        "What acts must be said in one of the ways that LANGUAGE.md, section 5, lists.";
    E307 unknown_choice(found, context, help) "a word that is not a choice"
        "`{found}` is not {context}" "" "{help}"
        "Only certain words are understood here.";
    E308 list_length(name, wanted, found) "a list of the wrong length"
        "`{name}` has {wanted} members, the list has {found}" "{found} values" ""
        "A list gives each member of a family its value, in order.";
    E309 bad_type_name(name, proposal) "a name that cannot be a Rust type"
        "`{name}` cannot be the name of a Rust type" "" "write it like `{proposal}`"
        "`name` becomes a type: letters and digits, the first a capital letter.";
    E310 duplicate_label(label, section) "a label given twice"
        "`{label}` is given twice in {section}" "given again" ""
        "Labels are unique in their section.";
    E311 needs_another_key(key, other, section) "a key that needs another"
        "`{key}` needs `{other}` in {section}" "" ""
        "Some keys make sense only together.";
    E312 family_not_allowed(section) "a family where none may be"
        "{section} takes no family" "" "write the entries out"
        "`name[i in 1..n]` declares members; here a single name is wanted.";
    E313 same_rust_name(name, other, rust) "two parameters with one name in Rust"
        "`{name}` and `{other}` are both `{rust}` in Rust" "" "choose another name for one of the two"
        "Parameters are fields and methods of the generated type, whose names are in ASCII: Greek letters become their names, accents are dropped, other scripts are transliterated. LANGUAGE.md, section 2, says how.";
    E314 scaled_coordinate(unit, si) "a unit of a coordinate that is not SI"
        "`{unit}` may stand only after a value" "" "write `{si}` here, and `30 {unit}` where the value is given"
        "Inside the model lengths are in metres, angles in radians and so on, and a number alone is in SI: a coordinate in `mm` that starts at `5` would start at 5 m. Values with units are converted.";
    E315 no_phases() "a phase in a model without phases"
        "the model has no phases" "names a phase" "declare them, `phases: {{rolling: [contact], flight: []}}`, or leave `phase` out"
        "`phase` says in which phases something acts, counts or is claimed; without `phases` there is one, and everything does.";
    E316 twice_in_list(name, list) "something twice in a list"
        "`{name}` stands twice in `{list}`" "listed again" "remove one of the two"
        "A list of phases, or of the constraints of a phase, names each once.";
    E317 empty_list(list, what) "a list of nothing"
        "`{list}` names no {what}" "expected at least one" ""
        "Without any member the entry would say nothing: leave the key out, or name one.";
    E318 two_phases() "an event that goes to two phases"
        "an event goes to one phase" "a second one" "leave one of them out, or write two events with an `if` each"
        "One phase is active at a time.";
    E319 bad_table(name, why, help) "points that make no function"
        "`{name}` is no function: {why}" "" "{help}"
        "A table has one value for each argument: at least two points, from left to right, and a periodic one ends as it begins. One of two arguments has a value for every x with every y.";
    E320 rough_table(name, slope, smooth, help) "a table that is not smooth enough"
        "`{slope}` enters the equations of motion, and jumps from piece to piece of `{name}`, which is smooth to order {smooth}" "" "{help}"
        "What moves a body enters with its second derivative, what has potential energy with its first; accelerations that jump unannounced would be integrated wrongly.";
    E321 shape_in_space(kind, help) "a shape in space in a model in the plane"
        "`{kind}` belongs to a drawing in space, and this model is in the plane" "" "{help}"
        "A model is in space where its vectors have three components or a frame turns about an axis.";
    E322 axes_without_place(name) "axes that are nowhere"
        "the frame `{name}` has axes and no place" "" "say where they begin, `axes: {{frame: {name}, at: P}}`"
        "A frame is directions alone; a body has a centre of mass, at which its axes are drawn.";
    E323 no_direction(key) "a direction that is none"
        "`{key}` has no direction" "its length is 0" "write a vector such as `ground.z` or `B.x`"
        "Of an axis or a normal the direction counts, not the length.";
    E324 no_exchange(why, help) "an exchange that is none"
        "this exchange {why}" "" "{help}"
        "An exchange gives each place what was in another: every coordinate and phase goes somewhere, and each place takes one. A state that is its own image with time reversed is so by something that done twice changes nothing.";
    E325 part_unlike_exchange(part, order) "a part of the period that does not fit"
        "`{part}` does not fit: what closes here gives the start back after {order} times" "" "write `1/{order}`, or leave `part` out"
        "A motion that comes to the image of its start after a part of its period comes to the start itself when the image has been taken as often as gives back the start. Between two states that are their own images with time reversed lies half of that part.";
    E326 bad_record(name, why, help) "a record that cannot be followed"
        "`{name}` is no record: {why}" "" "{help}"
        "A record has a column of rising times and one for each quantity that was measured.";
    E327 acts_in_all_phases() "what acts in one phase of contacts"
        "`friction` and `contacts` decide by themselves what sticks, slips or is open, and nothing else acts in some of these phases only" "names a phase" "leave `phase` out; `checks`, `conserved` and `balances` may name what contacts do, `phase: rub sticks`"
        "A force, an event or a scene of a file with contacts belongs to all phases: which of them comes next is decided by the forces.";
    E328 two_modes(words) "two things that a contact does at once"
        "no phase is `{words}`: a contact does one thing at a time" "" "write a list, `[rub slips forwards, rub slips backwards]`, for what holds in either"
        "Between commas stands what several contacts do at once; a list names several phases.";
}
