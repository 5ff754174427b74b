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
10 ; time: 0:00:11 h, accelerations included
11 ; of it with T7: 0:00:05 h
12 ; of it with T8: 0:00:06 h
13 ; moves: 28
14 ; assumes at most 12.50 mm of stock
15 ; taken up at line 30; the figures above are of the whole program
16 M127
17 M117
18 CYCL DEF 32.0 TOLERANCE
19 CYCL DEF 32.1 T0.02
20 L Y+100.0 FMAX
21 TOOL CALL 7 Z
22 TOOL CALL S6000
23 M4
24 M8
25 L Y+100.0 FMAX
26 L X+10.6 A+200.0 FMAX
27 L Y+69.6 F61.809
28 L F61.809
29 L X+10.9 Y+69.4 IA+100.0 F54.083
30 L X+11.2 Y+69.2 IA+100.0 F48.074
31 L X+11.5 Y+69.0 IA+100.0 F43.266
32 CYCL DEF 9.0 DWELL TIME
33 CYCL DEF 9.1 DWELL 0.25
34 L X+14.5 F600.0
35 L Y+80.0 IA-80.0 FMAX
36 L Y+70.0 F1200.0
37 L IA-10.0 F1200.0
38 L Y+100.0 FMAX
39 M5
40 M9
41 L Y+100.0 FMAX
42 TOOL CALL 8 Z
43 TOOL CALL S6000
44 M3
45 M8
46 L Y+100.0 FMAX
47 L X+30.0 A+360.0 FMAX
48 L Y+70.0 F1200.0
49 L X+30.3 Y+69.8 IA+100.0 F72.111
50 L X+30.6 Y+69.6 IA+100.0 F61.809
51 L X+30.9 Y+69.4 IA+100.0 F54.083
52 L X+31.2 Y+69.2 IA+100.0 F48.074
53 L X+31.5 Y+69.0 IA+100.0 F43.266
54 CYCL DEF 9.0 DWELL TIME
55 CYCL DEF 9.1 DWELL 0.25
56 L X+34.5 F600.0
57 L Y+80.0 IA-80.0 FMAX
58 L Y+70.0 F1200.0
59 L IA-10.0 F1200.0
60 L Y+100.0 FMAX
61 M5
62 M9
63 M30
64 END PGM HORMA0012 MM
