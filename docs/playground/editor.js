// A text area with colours: behind it lies the same text, coloured and underlined, and beside it its lines.

const TOKENS = [
    ["comment", /#.*/y],
    ["header", /^[ \t]*\[\[?[^\]\n]*\]\]?/my],
    ["string", /"""[^]*?(?:"""|$)|'''[^]*?(?:'''|$)|"(?:[^"\\\n]|\\.)*"?|'[^'\n]*'?/y],
    ["key", /[A-Za-z0-9_-]+(?=[ \t]*(?:\.[ \t]*[A-Za-z0-9_-]+[ \t]*)*=)/y],
    ["constant", /\b(?:true|false)\b/y],
    ["number", /[-+]?\b[0-9][0-9_.eE+-]*\b/y],
];
const QUANTITY = /^(["'])([-+]?[0-9][0-9.eE_+-]*) ([^"']+)\1$/;

export function tokens(text) {
    const found = [];
    for (let at = 0; at < text.length;) {
        let end = at;
        for (const [kind, pattern] of TOKENS) {
            pattern.lastIndex = at;
            const match = pattern.exec(text);
            if (!match?.[0]) continue;
            end = at + match[0].length;
            const quantity = kind === "string" && QUANTITY.exec(match[0]);
            if (quantity) found.push([at, at + 1 + quantity[2].length, "number"], [at + 1 + quantity[2].length, end, "unit"]);
            else found.push([at, end, kind]);
            break;
        }
        at = Math.max(end, at + 1);
    }
    return found;
}

/** Offsets at which lines begin. */
const startsOf = (text) => [0, ...[...text.matchAll(/\n/g)].map((m) => m.index + 1)];

export class Editor {
    constructor(root, { changed, complete }) {
        this.area = root.querySelector("textarea");
        this.ink = root.querySelector("pre");
        this.gutter = root.querySelector(".gutter");
        this.list = root.querySelector(".choices");
        this.sheet = root.querySelector(".sheet");
        this.problems = [];
        this.choices = null;
        this.asked = 0; // questions for completions; answers to all but the last one are late
        this.ask = complete;
        this.area.addEventListener("input", (event) => {
            this.draw();
            changed();
            if (event.inputType?.startsWith("insert") && /[\w"[]$/.test(event.data ?? "")) this.offer();
            else this.close();
        });
        this.area.addEventListener("keydown", (event) => this.key(event));
        this.area.addEventListener("blur", () => this.close());
        this.area.addEventListener("click", () => this.close());
    }

    get text() { return this.area.value; }

    set text(text) {
        this.area.value = text;
        this.area.setSelectionRange(0, 0);
        this.sheet.scrollTo(0, 0);
        this.problems = [];
        this.close();
        this.draw();
    }

    /** Show problems: each has line and column, from 1, of its beginning and end. */
    mark(problems) {
        const starts = startsOf(this.text), size = this.text.length;
        // Columns count characters, offsets of JavaScript halves of them.
        const offset = (line, column) => {
            const start = starts[line - 1] ?? size;
            let at = start;
            for (let i = 1; i < column && at < size; i++) at += this.text.codePointAt(at) > 0xffff ? 2 : 1;
            return at;
        };
        this.problems = problems.filter((p) => p.line).map((p) => {
            const start = offset(p.line, p.column);
            const end = Math.max(start + 1, offset(p.end_line ?? p.line, p.end_column ?? p.column + 1));
            return { start, end, severity: p.severity, line: p.line };
        });
        this.draw();
    }

    draw() {
        const text = this.text, pieces = tokens(text);
        const cuts = new Set([0, text.length]);
        for (const [a, b] of pieces) cuts.add(a).add(b);
        for (const { start, end } of this.problems) cuts.add(Math.min(start, text.length)).add(Math.min(end, text.length));
        const at = [...cuts].sort((a, b) => a - b);
        const shown = document.createDocumentFragment();
        let piece = 0;
        for (let i = 0; i + 1 < at.length; i++) {
            while (piece < pieces.length && pieces[piece][1] <= at[i]) piece++;
            const kind = pieces[piece]?.[0] <= at[i] ? pieces[piece][2] : "";
            const problem = this.problems.find((p) => p.start <= at[i] && at[i] < p.end);
            const span = document.createElement("span");
            span.className = problem ? `${kind} wrong ${problem.severity}` : kind;
            span.textContent = text.slice(at[i], at[i + 1]);
            shown.append(span);
        }
        shown.append("\n");
        this.ink.replaceChildren(shown);
        const wrong = new Map(this.problems.map((p) => [p.line, p.severity]));
        const lines = startsOf(text).map((_, i) => {
            const number = document.createElement("span");
            number.textContent = i + 1;
            number.className = wrong.get(i + 1) ?? "";
            return number;
        });
        this.gutter.replaceChildren(...lines);
    }

    /** Put the caret at a problem. */
    go(number) {
        const problem = this.problems[number];
        if (!problem) return;
        this.area.focus();
        this.area.setSelectionRange(problem.start, Math.min(problem.end, this.text.length));
        this.sheet.scrollTo({ top: (problem.line - 4) * this.lineHeight(), behavior: "smooth" });
    }

    lineHeight() { return parseFloat(getComputedStyle(this.ink).lineHeight); }

    async offer(isAsked = false) {
        const at = this.area.selectionStart, text = this.text;
        if (at !== this.area.selectionEnd || !isAsked && /(?<![\w])\d\w*$/.test(text.slice(0, at))) return this.close();
        const number = ++this.asked;
        // Python counts characters.
        const found = await this.ask(text, [...text.slice(0, at)].length);
        if (!found || number !== this.asked || this.area.selectionStart !== at || this.text !== text) return;
        const start = at - (/[\w]*$/.exec(text.slice(0, at))[0].length);
        const rest = found.filter((c) => c.text !== text.slice(start, at)).slice(0, 60);
        if (!rest.length || !isAsked && at === start && !/["[ ]$/.test(text.slice(0, at))) return this.close();
        // Enter takes what was asked for or moved to; a list that came by itself leaves it a new line.
        this.choices = { rest, start, end: at, chosen: isAsked ? 0 : -1 };
        this.list.replaceChildren(...rest.map((choice, i) => {
            const item = document.createElement("li"), says = document.createElement("small");
            item.id = `choice-${i}`;
            item.setAttribute("role", "option");
            item.className = choice.kind;
            says.textContent = choice.says;
            item.append(choice.text, says);
            item.addEventListener("mousedown", (event) => {
                event.preventDefault();
                this.choices.chosen = i;
                this.accept();
            });
            return item;
        }));
        this.list.hidden = false;
        this.place(start);
        this.choose(this.choices.chosen);
    }

    /** Put the list below the word, or above it where there is no room. */
    place(start) {
        const before = this.text.slice(0, start), line = before.split("\n").length - 1;
        const column = start - before.lastIndexOf("\n") - 1;
        const ruler = document.createElement("span");
        ruler.textContent = "0".repeat(100);
        this.ink.append(ruler);
        const width = ruler.getBoundingClientRect().width / 100, height = this.lineHeight();
        ruler.remove();
        const left = this.ink.offsetLeft + 12 + column * width - this.sheet.scrollLeft;
        const top = 10 + (line + 1) * height - this.sheet.scrollTop;
        const most = this.sheet.clientWidth - this.list.offsetWidth - 4;
        this.list.style.left = `${Math.max(4, Math.min(left, most))}px`;
        const above = top - height - this.list.offsetHeight;
        const isLow = top + this.list.offsetHeight > this.sheet.clientHeight && above > 0;
        this.list.style.top = `${isLow ? above : top}px`;
    }

    choose(i) {
        const items = [...this.list.children];
        items.forEach((item, k) => item.setAttribute("aria-selected", k === i));
        items[i]?.scrollIntoView({ block: "nearest" });
        this.choices.chosen = i;
        if (i < 0) this.area.removeAttribute("aria-activedescendant");
        else this.area.setAttribute("aria-activedescendant", `choice-${i}`);
    }

    accept() {
        const { rest, start, end, chosen } = this.choices;
        this.close();
        this.area.setSelectionRange(start, end);
        // The one way that the browser's undo remembers.
        if (!document.execCommand("insertText", false, rest[chosen].text)) {
            this.area.setRangeText(rest[chosen].text, start, end, "end");
            this.area.dispatchEvent(new Event("input"));
        }
        this.close();
    }

    close() {
        this.asked++;
        this.choices = null;
        this.list.hidden = true;
        this.area.removeAttribute("aria-activedescendant");
    }

    key(event) {
        if (event.key === " " && event.ctrlKey) {
            event.preventDefault();
            return this.offer(true);
        }
        if (event.key === "F8" && this.problems.length) {
            event.preventDefault();
            const at = this.area.selectionStart, next = this.problems.findIndex((p) => p.start > at);
            return this.go(Math.max(next, 0));
        }
        if (!this.choices) return;
        const { rest, chosen } = this.choices, size = rest.length;
        if (event.key === "ArrowDown") this.choose((chosen + 1) % size);
        else if (event.key === "ArrowUp") this.choose((chosen + size - 1 + (chosen < 0)) % size);
        else if (event.key === "Tab" && chosen < 0) this.choose(0);
        else if ((event.key === "Enter" || event.key === "Tab") && chosen >= 0) this.accept();
        else if (event.key === "Escape") this.close();
        else return;
        event.preventDefault();
    }
}
