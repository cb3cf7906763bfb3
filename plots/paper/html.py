"""The report as one HTML file: Markdown converted, pictures inside as data URIs, plain CSS."""

import base64
import re

import markdown

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; margin-top: 2rem; }
p, li { max-width: 48rem; }
img { max-width: 100%; }
table { border-collapse: collapse; display: block; overflow-x: auto; font-size: 0.85rem; margin: 1rem 0; }
th, td { border-bottom: 1px solid #ddd; padding: 0.25rem 0.6rem; text-align: left; vertical-align: top; }
th { border-bottom: 2px solid #888; }
code { font-size: 0.9em; background: #f3f3f3; padding: 0 0.2em; }
pre { background: #f3f3f3; padding: 0.6rem; overflow-x: auto; }
@media print { body { max-width: none; } table { display: table; } h2, h3 { break-after: avoid; } }
"""


def embed(page, folder):
    """Pictures that are files of the folder become part of the page."""

    def picture(found):
        data = base64.b64encode((folder / found[1]).read_bytes()).decode()
        return f'src="data:image/png;base64,{data}"'

    return re.sub(r'src="([^":]+\.png)"', picture, page)


def convert(text, folder):
    """A page of Markdown text whose pictures are in the folder."""
    body = markdown.markdown(text, extensions=["tables", "fenced_code", "toc"])
    title = re.search(r"^# (.+)$", text, re.MULTILINE)
    page = f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<meta name="viewport" content="width=device-width">\n<title>{title[1] if title else "Report"}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n'
    return embed(page, folder)
