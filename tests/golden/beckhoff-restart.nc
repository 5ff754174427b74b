(part: a last)
(a remark so long that no control would take it on a single line, not even in brackets [as here], which is why it has to be broken where a blank allows it, and on it goes for yet another while until the longest lines are too short, which)
(takes more than five hundred characters where Siemens is concerned, so that the writer of this remark has to think of ever more to say about nothing, and comes in the end to the weather, which is fair, and to the wood, which is hornbeam,)
(dried for two winters)
(X: 10.0000 to 34.5000 mm)
(Y: 69.0000 to 100.0000 mm)
(A: 0.0000 to 860.0000 deg)
(time: 0:00:11 h, accelerations included)
(of it with T7: 0:00:05 h)
(of it with T8: 0:00:06 h)
(moves: 28)
(assumes at most 12.50 mm of stock)
(taken up at line 25; the figures above are of the whole program)
G71 G90 G94 G17 G40 G54
G0 Y100.0
T7 M6
S6000.0 M4
M7
G0 Y100.0
G0 X10.6 A200.0
G1 Y69.6 F1200.0
G93
G1 X10.9 Y69.4 A300.0 F0.4
G1 X11.2 Y69.2 A400.0 F0.45
G1 X11.5 Y69.0 A500.0 F0.5
G4 X0.25
G94
G1 X14.5 F600.0
G0 Y80.0 A420.0
G1 Y70.0 F1200.0
G93
G1 A410.0 F0.5
G94
G0 Y100.0
M5
M9
G0 Y100.0
T8 M6
S6000.0 M3
M7
G0 Y100.0
G0 X30.0 A360.0
G1 Y70.0 F1200.0
G93
G1 X30.3 Y69.8 A460.0 F0.3
G1 X30.6 Y69.6 A560.0 F0.35
G1 X30.9 Y69.4 A660.0 F0.4
G1 X31.2 Y69.2 A760.0 F0.45
G1 X31.5 Y69.0 A860.0 F0.5
G4 X0.25
G94
G1 X34.5 F600.0
G0 Y80.0 A780.0
G1 Y70.0 F1200.0
G93
G1 A770.0 F0.5
G94
G0 Y100.0
M5
M9
M30
