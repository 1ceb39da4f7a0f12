// The library in a thread of its own, so that a page stays alive while it derives and runs; it gets the compiled module first, then questions.

let module, library;
const read = length => new TextDecoder().decode(new Uint8Array(library.memory.buffer, library.answered(), length));

// What the library answers; after a panic or a trap it begins anew.
function answerTo(question) {
  try {
    library ??= new WebAssembly.Instance(module, foreign(module)).exports;
    const bytes = new TextEncoder().encode(JSON.stringify(question));
    const place = library.question(bytes.length);
    new Uint8Array(library.memory.buffer, place, bytes.length).set(bytes);
    return JSON.parse(read(library.answer()));
  } catch (trap) {
    const told = library && read(library.panicked());
    library = undefined;
    return {error: `error: the library failed, which is a fault of its own: ${told || trap}`};
  }
}

// What the module could call but does not: functions of a page, which one of its parts names (plotters, for text on a canvas).
function foreign(module) {
  const functions = {};
  for (const {module: from, name} of WebAssembly.Module.imports(module)) {
    (functions[from] ??= {})[name] = () => { throw new Error(`${name} is not there`); };
  }
  return functions;
}

onmessage = ({data}) => {
  if (data instanceof WebAssembly.Module) module = data;
  else postMessage({number: data.number, answer: answerTo(data)});
};
