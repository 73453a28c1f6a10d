// A model in the address of the page: compressed, behind the #, which browsers send nowhere.

const LONGEST = 400_000; // characters of a model; what claims to be more is no model

async function through(bytes, stream) {
    const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
    const pieces = [];
    let size = 0;
    for (let part; !(part = await reader.read()).done;) {
        size += part.value.length;
        if (size > LONGEST) throw new RangeError("too long");
        pieces.push(part.value);
    }
    return new Uint8Array(await new Blob(pieces).arrayBuffer());
}

/** The fragment that stands for a model. */
export async function link(text) {
    const packed = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
    const letters = Array.from(packed, (byte) => String.fromCharCode(byte)).join("");
    return `#model=${btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

/** The model of a fragment, null if there is none, or if it is damaged. */
export async function model(fragment) {
    const found = /^#model=([\w-]+)$/.exec(fragment);
    if (!found) return null;
    try {
        const letters = atob(found[1].replaceAll("-", "+").replaceAll("_", "/"));
        const packed = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
        return new TextDecoder("utf-8", { fatal: true }).decode(await through(packed, new DecompressionStream("deflate-raw")));
    } catch {
        return null;
    }
}
