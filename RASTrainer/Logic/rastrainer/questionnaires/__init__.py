"""What trainees are asked: SUS, raw NASA-TLX, SSQ; how answers are checked and scored."""
