"""Pages with sliders: one HTML file that needs neither a network nor a server.

Input: models.
Output: :func:`symflex.live.page.live_page` returns the page. Its script evaluates what
``symflex export --to js`` prints, carries poles and zeros along while parameters move and proves them
(:mod:`~symflex.live.tape`, ``roots.js``), and draws.
"""
