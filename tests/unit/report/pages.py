"""A reader of pages that knows nothing of the printer."""

from html.parser import HTMLParser

VOID = frozenset("meta br img link input hr".split())
ADDRESSES = ("src", "href", "xlink:href", "action", "data", "poster", "srcset", "formaction")


class Page(HTMLParser):
    """Elements, identifiers, addresses and text of a page; an element that is not closed is an error."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.ids, self.addresses, self.handlers, self.texts = [], [], [], [], []
        self._open = []
        self.feed(text)
        self.close()
        assert not self._open, self._open

    def handle_starttag(self, tag, attrs):
        self._start(tag, attrs)
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self._start(tag, attrs)

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        self.texts.append((self._open[-1] if self._open else "", data))

    def _start(self, tag, attrs):
        self.elements.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value)
            if name in ADDRESSES:
                self.addresses.append(value)
            if name.startswith("on"):
                self.handlers.append((tag, name))

    def text(self, outside=("style",)):
        return "".join(data for tag, data in self.texts if tag not in outside)
