(part: a last)
(a remark so long that no control would take it on a single)
(line, not even in brackets [as here], which is why it has to be)
(broken where a blank allows it, and on it goes for yet another)
(while until the longest lines are too short, which takes more)
(than five hundred characters where Siemens is concerned, so)
(that the writer of this remark has to think of ever more to say)
(about nothing, and comes in the end to the weather, which is)
(fair, and to the wood, which is hornbeam, dried for two winters)
(X: 10.0000 to 34.5000 mm)
(Y: 69.0000 to 100.0000 mm)
(Z: 0.0000 to 20.0000 mm)
(time: 0:00:11 h, accelerations included)
(of it with T7: 0:00:05 h)
(of it with T8: 0:00:06 h)
(moves: 30)
(assumes at most 12.50 mm of stock)
(taken up at line 31; the figures above are of the whole program)
G21 G90 G94 G17 G40 G49 G80 G54
G0 Z20.0
T7 M0
S6000 M4
M8
G0 Z20.0
G0 X10.6 Y69.6
G1 Z2.0 F1200.0
G93
G1 X10.9 Y69.4 Z3.0 F150.0
G1 X11.2 Y69.2 Z4.0 F133.333
G1 X11.5 Y69.0 Z5.0 F120.0
G4 P0.25
G94
G1 X14.5 F600.0
G0 Y80.0 Z4.2
G1 Y70.0 F1200.0
G93
G1 Z4.1 F120.0
G94
G0 Z20.0
M5
M9
G0 Z20.0
T8 M0
S6000 M3
M8
G0 Z20.0
G0 X30.0 Y100.0
G0 Z0.0
G1 Y70.0 F1200.0
G93
G1 X30.3 Y69.8 Z1.0 F200.0
G1 X30.6 Y69.6 Z2.0 F171.428
G1 X30.9 Y69.4 Z3.0 F150.0
G1 X31.2 Y69.2 Z4.0 F133.333
G1 X31.5 Y69.0 Z5.0 F120.0
G4 P0.25
G94
G1 X34.5 F600.0
G0 Y80.0 Z4.2
G1 Y70.0 F1200.0
G93
G1 Z4.1 F120.0
G94
G0 Z20.0
M5
M9
M30
