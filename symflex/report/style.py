"""The style sheet of the page: light and dark, screen, telephone and paper."""

from __future__ import annotations

from typing import Final

STYLE: Final = """
:root{color-scheme:light dark;--ink:#1b1d22;--paper:#fff;--soft:#f4f5f7;--line:#d9dce1;--quiet:#6b7078;
--faint:#e6e8eb;
--link:#0b5cad;--good:#17692f;--fair:#7d5200;--bad:#a8231d;--goodbg:#e4f4e8;--fairbg:#fbefd6;
--badbg:#fbe6e4;
--c1:#0072b2;--c2:#c65300;--c3:#00805d;--c4:#b3538a;--c5:#b87d00;--c6:#2b8fc7}
@media (prefers-color-scheme:dark){:root{--ink:#e4e6ea;--paper:#14161a;--soft:#1e2126;--line:#3a3f47;
--quiet:#9aa1ab;
--faint:#2c3037;--link:#7db8f2;--good:#7fd694;--fair:#e8bd62;--bad:#ff9b92;--goodbg:#173322;
--fairbg:#3a2c0f;
--badbg:#431d1b;--c1:#57b3ec;--c2:#ff9147;--c3:#3fcfa4;--c4:#e79cc6;--c5:#f0b93a;--c6:#8fd0f5}}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0 auto;padding:0 1.25rem 4rem;max-width:60rem;background:var(--paper);color:var(--ink);
font:1rem/1.55 "Source Sans 3","Segoe UI",Roboto,"Helvetica Neue",Arial,"Noto Sans",sans-serif;
overflow-wrap:break-word}
header{padding:3rem 0 1rem;border-bottom:1px solid var(--line)}
header p{color:var(--quiet);margin:.25rem 0 0}
h1{font-size:2rem;line-height:1.2;margin:0;text-wrap:balance}
h2{font-size:1.5rem;line-height:1.25;margin:3.5rem 0 1rem;padding-bottom:.3rem;
border-bottom:1px solid var(--line)}
h3{font-size:1.2rem;margin:2.25rem 0 .6rem}
h4,h5,h6{font-size:1.05rem;margin:1.75rem 0 .4rem}
h4 math{font-size:1.2em}small{color:var(--quiet);font-size:.9em}
p{margin:.6rem 0;max-width:46rem}
a{color:var(--link);text-underline-offset:.15em}
a:focus-visible,summary:focus-visible,.scroll:focus-visible,.formula:focus-visible{
outline:2px solid var(--link);
outline-offset:2px}
.skip{position:absolute;left:-99rem}.skip:focus{left:1rem;top:1rem;background:var(--paper);padding:.5rem}
nav ol,nav ul{margin:.3rem 0;padding-left:1.4rem}
nav ul{display:flex;flex-wrap:wrap;gap:0 1rem;list-style:none;padding:0;font-size:.9rem}
nav summary{font-weight:600;margin-top:1rem}
nav a{text-decoration:none}nav a:hover{text-decoration:underline}
code,pre,.tt{font-family:ui-monospace,"Cascadia Mono",Menlo,Consolas,"DejaVu Sans Mono",monospace;
font-size:.88em}
pre{background:var(--soft);padding:.9rem 1rem;overflow-x:auto;border-radius:.4rem;line-height:1.4;
tab-size:4}
details{margin:.8rem 0}summary{cursor:pointer}
.scroll{overflow-x:auto;margin:1rem 0}
table{border-collapse:collapse;font-size:.93rem;line-height:1.4}
caption{text-align:left;font-weight:600;padding:.2rem 0}
th,td{padding:.38rem .9rem .38rem 0;vertical-align:top;text-align:left;border-bottom:1px solid var(--line)}
th{border-bottom:2px solid var(--line);font-weight:600;vertical-align:bottom}
th:last-child,td:last-child{padding-right:0}
.number{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.plain{white-space:nowrap}
td.text{min-width:6.5rem}
strong.good,strong.fair,strong.bad,strong.quiet{font-weight:600;border-radius:.3rem;padding:.05rem .4rem;
white-space:nowrap}
strong.good{color:var(--good);background:var(--goodbg)}strong.fair{color:var(--fair);
background:var(--fairbg)}
strong.bad{color:var(--bad);background:var(--badbg)}strong.quiet{color:var(--quiet);background:var(--soft)}
.notice{border-left:.25rem solid var(--fair);background:var(--fairbg);padding:.5rem .8rem;
border-radius:.2rem}
math{font-family:"Latin Modern Math","STIX Two Math","Cambria Math","Libertinus Math",math;font-size:1.08em}
math .it{font-style:italic}math .bf{font-weight:bold}math .sf{font-family:sans-serif}
.formula{margin:1rem 0;padding:.2rem 0 .2rem 1rem;border-left:.2rem solid var(--faint);overflow-x:auto}
.row{margin:.7rem 0;padding-left:2.2rem;text-indent:-2.2rem;line-height:2}
.row math{text-indent:0}
.where{display:flex;flex-wrap:wrap;align-items:baseline;gap:.1rem 1.8rem}
.where .row{margin:.3rem 0;line-height:1.7}
.where span{color:var(--quiet)}
figure{margin:1.5rem 0;padding:0}
figcaption{color:var(--quiet);font-size:.93rem;margin-top:.4rem;max-width:46rem}
svg.plot{display:block;width:100%;height:auto}
svg.plot *{stroke-linejoin:round;stroke-linecap:butt}
svg.plot{fill:var(--ink)}
@media (max-width:40rem){body{padding:0 .9rem 3rem}header{padding-top:1.5rem}h1{font-size:1.5rem}
h2{font-size:1.3rem}
.formula{padding-left:.6rem}.row{padding-left:1.2rem;text-indent:-1.2rem}td.text{min-width:7rem}
.stack,.stack tbody,.stack tr,.stack td{display:block}.stack thead{display:none}.stack caption{display:block}
.stack tr{border-bottom:2px solid var(--line);padding:.5rem 0}
.stack td{border:0;padding:.1rem 0;text-align:left;white-space:normal}
.stack td:empty{display:none}
.stack td:not(:first-child)::before{content:attr(data-head) ": ";color:var(--quiet)}}
@media print{:root{color-scheme:light;--ink:#000;--paper:#fff;--soft:#f4f5f7;--line:#bbb;--quiet:#555;
--faint:#ddd;--link:#000;
--good:#17692f;--fair:#7d5200;--bad:#a8231d;--goodbg:#fff;--fairbg:#fff;--badbg:#fff;
--c1:#0072b2;--c2:#c65300;--c3:#00805d;--c4:#b3538a;--c5:#b87d00;--c6:#2b8fc7}
body{max-width:none;padding:0;font-size:10pt}nav,.skip{display:none}a{text-decoration:none}
.scroll,.formula{overflow:visible}table{font-size:8.5pt}h2,h3,h4{break-after:avoid}
figure,.formula,tr{break-inside:avoid}figcaption span{display:none}pre{white-space:pre-wrap;font-size:7.5pt}}
"""
