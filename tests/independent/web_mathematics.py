"""Commands of mathematics that KaTeX and MathJax have in common.

The base, ams and boldsymbol packages of MathJax 3.2 list their commands (its documentation, "Supported
TeX/LaTeX commands"); each was given to KaTeX 0.16 in its strict mode and to MathJax, alone, with an argument
and with two, and those that both set without an error are kept; and ``right``, which goes with ``left``.
"""

COMMANDS = frozenset(
    """
    And Bbb Bbbk Big Bigg Biggl Biggm Biggr Bigl Bigm Bigr Box Bumpeq Cap Cup Delta Diamond Doteq Finv
    Game Gamma Huge Im Join LARGE LaTeX Lambda Large Leftarrow Leftrightarrow Lleftarrow Longleftarrow
    Longleftrightarrow Longrightarrow Lsh Omega Phi Pi Pr Psi Re Rightarrow Rrightarrow Rsh S Sigma
    Subset Supset TeX Theta Upsilon Vdash Vvdash Xi acute aleph alpha amalg angle approx approxeq arccos
    arcsin arctan arg ast asymp atop backepsilon backprime backsim backsimeq backslash bar barwedge
    because beta beth between bf big bigcap bigcirc bigcup bigg biggl biggm biggr bigl bigm bigodot
    bigoplus bigotimes bigr bigsqcup bigstar bigtriangledown bigtriangleup biguplus bigvee bigwedge
    binom blacklozenge blacksquare blacktriangle blacktriangledown blacktriangleleft blacktriangleright
    bmod boldsymbol bot bowtie boxdot boxed boxminus boxplus boxtimes brace brack breve bullet bumpeq
    cal cap cdot cdotp cdots centerdot cfrac check checkmark chi choose circ circeq circlearrowleft
    circlearrowright circledR circledS circledast circledcirc circleddash clubsuit colon complement cong
    coprod cos cosh cot coth cr csc cup curlyeqprec curlyeqsucc curlyvee curlywedge curvearrowleft
    curvearrowright dagger daleth dashleftarrow dashrightarrow dashv dbinom ddagger ddddot dddot ddot
    ddots deg delta det dfrac diagdown diagup diamond diamondsuit digamma dim displaystyle div
    divideontimes dot doteq doteqdot dotplus dots dotsb dotsc dotsi dotsm dotso doublebarwedge doublecap
    doublecup downdownarrows downharpoonleft downharpoonright ell emptyset enspace epsilon eqcirc eqsim
    eqslantgtr eqslantless equiv eta eth exists exp fallingdotseq fbox flat forall frac frak frown gamma
    gcd ge geq geqq geqslant gets gg ggg gggtr gimel gnapprox gneq gneqq gnsim grave gt gtrapprox gtrdot
    gtreqless gtreqqless gtrless gtrsim gvertneqq hat hbar hbox heartsuit hom hookleftarrow
    hookrightarrow hphantom hslash huge iff iiint iint imath impliedby implies in inf infty injlim int
    intercal intop iota it jmath kappa ker lambda land large ldotp ldots le leadsto left leftarrow
    leftarrowtail leftharpoondown leftharpoonup leftleftarrows leftrightarrow leftrightarrows
    leftrightharpoons leftrightsquigarrow leftthreetimes leq leqq leqslant lessapprox lessdot lesseqgtr
    lesseqqgtr lessgtr lesssim lg lhd lim liminf limsup ll llap lll llless ln lnapprox lneq lneqq lnot
    lnsim log longleftarrow longleftrightarrow longmapsto longrightarrow looparrowleft looparrowright
    lor lozenge lt ltimes lvertneqq maltese mapsto mathbb mathbf mathbin mathcal mathclose mathfrak
    mathinner mathit mathnormal mathop mathopen mathord mathpunct mathrel mathring mathrm mathscr mathsf
    mathsfit mathstrut mathtt max measuredangle mho mid min mod models mp mu multimap nLeftarrow
    nLeftrightarrow nRightarrow nVDash nVdash nabla natural ncong ne nearrow neg negmedspace
    negthickspace negthinspace neq newline nexists ngeq ngeqq ngeqslant ngtr ni nleftarrow
    nleftrightarrow nleq nleqq nleqslant nless nmid nobreakspace nonumber normalsize not notag notin
    nparallel nprec npreceq nrightarrow nshortmid nshortparallel nsim nsubseteq nsubseteqq nsucc nsucceq
    nsupseteq nsupseteqq ntriangleleft ntrianglelefteq ntriangleright ntrianglerighteq nu nvDash nvdash
    nwarrow odot oint omega omicron ominus operatorname oplus oslash otimes over overbrace overleftarrow
    overleftrightarrow overline overrightarrow overset owns parallel partial perp phantom phi pi
    pitchfork pm pmb pmod pod prec precapprox preccurlyeq preceq precnapprox precneqq precnsim precsim
    prime prod projlim propto psi qquad quad restriction rhd rho rightarrow rightarrowtail
    right rightharpoondown rightharpoonup rightleftarrows rightleftharpoons rightrightarrows rightsquigarrow
    rightthreetimes risingdotseq rlap rm rtimes scriptscriptstyle scriptsize scriptstyle searrow sec
    setminus sf sharp shortmid shortparallel sigma sim simeq sin sinh small smallfrown smallint
    smallsetminus smallsmile smash smile space spadesuit sphericalangle sqcap sqcup sqrt sqsubset
    sqsubseteq sqsupset sqsupseteq square stackrel star subset subseteq subseteqq subsetneq subsetneqq
    substack succ succapprox succcurlyeq succeq succnapprox succneqq succnsim succsim sum sup supset
    supseteq supseteqq supsetneq supsetneqq surd swarrow tag tan tanh tau tbinom text textbf textit
    textnormal textrm textsf textstyle texttt textup tfrac therefore theta thickapprox thicksim
    thinspace tilde times tiny to top triangle triangledown triangleleft trianglelefteq triangleq
    triangleright trianglerighteq tt twoheadleftarrow twoheadrightarrow underbrace underleftarrow
    underleftrightarrow underline underrightarrow underset unlhd unrhd upharpoonleft upharpoonright
    uplus upsilon upuparrows vDash varDelta varGamma varLambda varOmega varPhi varPi varPsi varSigma
    varTheta varUpsilon varXi varepsilon varinjlim varkappa varliminf varlimsup varnothing varphi varpi
    varprojlim varpropto varrho varsigma varsubsetneq varsubsetneqq varsupsetneq varsupsetneqq vartheta
    vartriangle vartriangleleft vartriangleright vcenter vdash vdots vec vee veebar vphantom wedge
    widehat widetilde wp wr xi xleftarrow xrightarrow yen zeta
    """.split()
)
ENVIRONMENTS = frozenset(("aligned", "array", "cases", "matrix", "pmatrix"))
