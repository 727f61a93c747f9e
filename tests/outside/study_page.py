"""What report.html of a study says: the data of its charts, its sentences, its table and the captions of its pictures."""
import html
import json
import re


def plain(text):
    return html.unescape(re.sub(r"<[^>]+>", " ", text)).strip()


class Page:
    def __init__(self, path):
        text = path.read_text(encoding="utf-8")
        self.data = json.loads(re.search(r'<script type="application/json" id="study">(.*?)</script>', text, re.S)[1])
        body = text[:text.index('<script type="application/json" id="study">')]
        self.titles = [model["name"] for model in self.data["models"]]
        self.series = [series["name"] for series in self.data["series"]]
        self.drawings = [", ".join(part for part in (one["method"], one["parameters"]) if part) for one in self.data["drawings"]]
        self.metrics = [metric["name"] for metric in self.data["metrics"]]
        self.sentences = self.sentences_of(body)
        self.charts = {stem: plain(words) for stem, words in
                       re.findall(r'<figure class="chart" id="(\w+)">.*?<p class="words">(.*?)</p>', body, re.S)}
        self.rows = [(int(model), int(drawing), re.findall(r'<td data-value="([^"]*)">', cells)) for model, drawing, cells in
                     re.findall(r'<tr data-model="(\d+)" data-drawing="(\d+)">(.*?)</tr>', body, re.S)]
        self.captions = [(int(model), int(drawing), plain(caption)) for model, drawing, caption in
                         re.findall(r'<figure class="cell"[^>]* data-model="(\d+)" data-drawing="(\d+)">.*?<figcaption>(.*?)</figcaption>',
                                    body, re.S)]

    def sentences_of(self, body):
        lead = plain(re.search(r'<p class="lead">(.*?)</p>', body, re.S)[1])
        results = re.search(r'<ul class="results">(.*?)</ul>', body, re.S)
        # A sentence ends where a capital follows, or a model or how many: numbers and names of models have points, too.
        names = "|".join(re.escape(title) for title in sorted(self.titles, key=len, reverse=True))
        end = re.compile(rf"(?<=\.) (?=[A-Z]|(?i:{names}) is as|\d+ others? (?:is|are) as)")
        items = [plain(item) for item in re.findall(r"<li>(.*?)</li>", results[1] if results else "", re.S)]
        return [sentence for text in (lead, *items) for sentence in (end.split(text) if not text.startswith("Warning:") else [text])]
