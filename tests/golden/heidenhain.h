0 BEGIN PGM HORMA0012 MM
1 ; part: a last
2 ; a remark so long that no control would take it on a single line, not even in brackets [as here], which is why
3 ; it has to be broken where a blank allows it, and on it goes for yet another while until the longest lines are
4 ; too short, which takes more than five hundred characters where Siemens is concerned, so that the writer of this
5 ; remark has to think of ever more to say about nothing, and comes in the end to the weather, which is fair, and
6 ; to the wood, which is hornbeam, dried for two winters
7 ; X: 10.0000 to 34.5000 mm
8 ; Y: 69.0000 to 100.0000 mm
9 ; A: 0.0000 to 860.0000 deg
10 ; time: 0:00:10 h, without acceleration
11 ; moves: 28
12 ; assumes at most 12.50 mm of stock
13 M127
14 M117
15 CYCL DEF 32.0 TOLERANCE
16 CYCL DEF 32.1 T0.02
17 L Y+100.0 FMAX
18 TOOL CALL 7 Z
19 TOOL CALL S6000
20 M4
21 M8
22 L Y+100.0 FMAX
23 L X+10.0 A+0.0 FMAX
24 L Y+70.0 F1200.0
25 L X+10.3 Y+69.8 IA+100.0 F72.111
26 L X+10.6 Y+69.6 IA+100.0 F61.809
27 L X+10.9 Y+69.4 IA+100.0 F54.083
28 L X+11.2 Y+69.2 IA+100.0 F48.074
29 L X+11.5 Y+69.0 IA+100.0 F43.266
30 CYCL DEF 9.0 DWELL TIME
31 CYCL DEF 9.1 DWELL 0.25
32 L X+14.5 F600.0
33 L Y+80.0 IA-80.0 FMAX
34 L Y+70.0 F1200.0
35 L IA-10.0 F1200.0
36 L Y+100.0 FMAX
37 M5
38 M9
39 L Y+100.0 FMAX
40 TOOL CALL 8 Z
41 TOOL CALL S6000
42 M3
43 M8
44 L Y+100.0 FMAX
45 L X+30.0 A+360.0 FMAX
46 L Y+70.0 F1200.0
47 L X+30.3 Y+69.8 IA+100.0 F72.111
48 L X+30.6 Y+69.6 IA+100.0 F61.809
49 L X+30.9 Y+69.4 IA+100.0 F54.083
50 L X+31.2 Y+69.2 IA+100.0 F48.074
51 L X+31.5 Y+69.0 IA+100.0 F43.266
52 CYCL DEF 9.0 DWELL TIME
53 CYCL DEF 9.1 DWELL 0.25
54 L X+34.5 F600.0
55 L Y+80.0 IA-80.0 FMAX
56 L Y+70.0 F1200.0
57 L IA-10.0 F1200.0
58 L Y+100.0 FMAX
59 M5
60 M9
61 M30
62 END PGM HORMA0012 MM
